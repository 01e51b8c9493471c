"""Names that the trial of the best explanation takes away, and what is left of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.diagnosis.evidence import trial
from fricomp.diagnosis.evidence.confirmation import Confirmation, PlainErrors
from fricomp.diagnosis.evidence.refitted import RefittedJoint
from fricomp.diagnosis.evidence.repetition import Repetitions
from fricomp.diagnosis.evidence.trial import Trial, leave_out_unfit, put_to_trial
from fricomp.diagnosis.joint.base import BASE_NAMES, unpack
from fricomp.diagnosis.search.explanation import Explanation

from ..known import known_baseline, known_fit, known_search

_CLEAR = PlainErrors(1.0, 0.3, 0.2)


def _try(
    monkeypatch: pytest.MonkeyPatch,
    *explanations: Explanation,
    shares: Repetitions,
    plain: PlainErrors = _CLEAR,
    against: dict[str, str] | None = None,
    quiet: bool = False,
) -> Trial:
    """Put the first of these to trial, where held-out data bear out all of them."""
    baseline = known_baseline(loudness=1.5)
    baseline = replace(baseline, nulls=replace(baseline.nulls, quiet=quiet))
    held = Confirmation(1.0, 0.3, 0.2, (0.5, 0.8), 0.9, plain)
    monkeypatch.setattr(trial, "repeat_choice", lambda *_: shares)
    monkeypatch.setattr(trial, "confirm", lambda *_, **__: held)
    monkeypatch.setattr(trial, "is_confirmed", lambda *_: True)
    monkeypatch.setattr(RefittedJoint, "refit", lambda *_: None)
    monkeypatch.setattr(trial, "list_objections", lambda *_, **__: dict(against or {}))
    return put_to_trial(baseline, known_search(*explanations), 0)


def _two() -> tuple[Explanation, Explanation]:
    baseline = known_baseline()
    both = known_fit(baseline, ["cogging", "stribeck_shape"], 500.0, coverage=0.99)
    return both, known_fit(baseline, ["cogging"], 450.0, coverage=0.95)


def test_a_name_that_seldom_comes_again_is_taken_away(monkeypatch: pytest.MonkeyPatch) -> None:
    baseline = known_baseline()
    both = known_fit(baseline, ["cogging", "load_coulomb"], 500.0, coverage=0.99)
    one = known_fit(baseline, ["cogging"], 450.0, coverage=0.95)
    shares = Repetitions(10, {("cogging", "load_coulomb"): 7, ("cogging",): 3})
    found = _try(monkeypatch, both, one, shares=shares)
    assert found.chosen is one
    assert "70%" in found.objections["load_coulomb"]


def test_nothing_is_named_where_the_plain_error_hardly_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    both, one = _two()
    shares = Repetitions(10, {("cogging",): 10})
    found = _try(monkeypatch, one, both, shares=shares, plain=PlainErrors(1.0, 0.9, 0.2))
    assert found.chosen is None
    assert found.failed is one
    assert "plain held-out error" in found.objections["cogging"]
    assert not found.immaterial


def test_what_no_plain_error_shows_is_nothing_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A log slower than its loop: torque between its rows is where rows weigh most, and no law of the catalogue."""
    both, one = _two()
    shares = Repetitions(10, {("cogging",): 10})
    found = _try(monkeypatch, one, both, shares=shares, plain=PlainErrors(1.0, 1.0, 0.2))
    assert found.chosen is None
    assert found.immaterial


@pytest.mark.parametrize(
    ("part", "acting", "quiet", "named"),
    [
        (0.003, 0.008, True, False),
        (0.003, 0.02, True, True),
        (0.03, 0.03, True, True),
        (0.003, 0.008, False, True),
        (0.002, 0.004, False, False),
        (0.002, 0.006, False, True),
    ],
)
def test_what_nobody_would_miss_has_no_name_where_nothing_hides_it(
    monkeypatch: pytest.MonkeyPatch, part: float, acting: float, quiet: bool, named: bool
) -> None:
    """A few thousandths of the friction, also where the effect acts, which at reversals alone may be more; in a log
    without noise, where all of a difference is seen, twice as much as in others."""
    both, one = _two()
    level = unpack(one.fit.theta[: len(BASE_NAMES)]).level
    size, shares = part * level, Repetitions(10, {("cogging",): 10})
    plain = PlainErrors(size, 0.01 * size, 0.001 * size, acting * level)
    found = _try(monkeypatch, one, both, shares=shares, plain=plain, quiet=quiet)
    assert (found.chosen is one) == named
    assert found.immaterial != named


def test_the_form_of_friction_is_a_remark_beside_what_covers_without_it(monkeypatch: pytest.MonkeyPatch) -> None:
    both, one = _two()
    shares = Repetitions(10, {("cogging", "stribeck_shape"): 10})
    found = _try(monkeypatch, both, one, shares=shares)
    assert found.chosen is one
    assert "form of the friction" in found.objections["stribeck_shape"]


def test_the_form_of_friction_is_a_name_where_the_rest_covers_too_little(monkeypatch: pytest.MonkeyPatch) -> None:
    both, _ = _two()
    weak = known_fit(known_baseline(), ["cogging"], 200.0, coverage=0.5, left=200.0)
    shares = Repetitions(10, {("cogging", "stribeck_shape"): 10})
    assert _try(monkeypatch, both, weak, shares=shares).chosen is both


def test_what_cannot_be_told_from_the_form_of_friction_is_a_remark_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    baseline = known_baseline()
    ripple = known_fit(baseline, ["cogging", "quadratic_drag"], 530.0, coverage=0.99)
    form = known_fit(baseline, ["quadratic_drag", "stribeck_shape"], 525.0, coverage=0.99)
    drag = known_fit(baseline, ["quadratic_drag"], 500.0, coverage=0.98)
    found = _try(monkeypatch, ripple, form, drag, shares=Repetitions(10, {ripple.names: 10}))
    assert found.chosen is drag
    assert "form of the friction" in found.objections["cogging"]


def test_the_form_of_friction_comes_back_where_what_stood_beside_it_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    """It was left out beside a ripple that few repetitions bring again, without which the drag covers too little."""
    baseline = known_baseline()
    three = known_fit(baseline, ["cogging", "quadratic_drag", "stribeck_shape"], 540.0, coverage=0.99)
    ripple = known_fit(baseline, ["cogging", "quadratic_drag"], 530.0, coverage=0.98)
    form = known_fit(baseline, ["quadratic_drag", "stribeck_shape"], 520.0, coverage=0.98)
    drag = known_fit(baseline, ["quadratic_drag"], 200.0, coverage=0.5, left=200.0)
    shares = Repetitions(10, {("quadratic_drag", "stribeck_shape"): 9, three.names: 1})
    found = _try(monkeypatch, three, ripple, form, drag, shares=shares)
    assert found.chosen is form
    assert set(found.objections) == {"cogging"}


def test_what_is_left_may_be_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    _, one = _two()
    shares = Repetitions(10, {("cogging",): 10})
    found = _try(monkeypatch, one, shares=shares, against={"cogging": "its interval holds zero"})
    assert found.chosen is None
    assert found.objections == {"cogging": "its interval holds zero"}


def test_what_stands_behind_an_effect_that_is_none_is_chosen_without_it() -> None:
    """A stop that may have no stiffness hid a push, which counts for less than it explains."""
    baseline = known_baseline()
    stop = known_fit(baseline, ["end_stop"], 500.0, coverage=0.98)
    both = known_fit(baseline, ["end_stop", "external_disturbance"], 520.0, coverage=0.99)
    push = known_fit(baseline, ["external_disturbance"], 510.0, coverage=0.99)
    found = known_search(stop, both, push)
    without = leave_out_unfit(baseline, found, Trial(unfit=frozenset({"end_stop"})))
    assert without is not None
    assert without.best is push
    assert {one.names for one in without.explanations if one.refused} == {stop.names, both.names}


@pytest.mark.parametrize("named", [True, False])
def test_nothing_is_left_out_where_something_is_named_or_its_numbers_are_sound(named: bool) -> None:
    baseline = known_baseline()
    push = known_fit(baseline, ["external_disturbance"], 510.0, coverage=0.99)
    stop = known_fit(baseline, ["end_stop"], 500.0, coverage=0.98)
    trial = Trial(chosen=push, unfit=frozenset({"end_stop"})) if named else Trial(objections={"end_stop": "seldom"})
    assert leave_out_unfit(baseline, known_search(stop, push), trial) is None


def test_without_what_is_shown_overwhelmingly_less_is_explained() -> None:
    """Whatever speaks against the rest, all of which must have been fitted."""
    baseline = known_baseline()
    both = known_fit(baseline, ["cogging", "spring_torque"], 900.0)
    one = known_fit(baseline, ["cogging"], 500.0, refused="no")
    assert trial._find_shown(known_search(both, one), both) == {"spring_torque"}
    assert trial._find_shown(known_search(both), both) == frozenset()
    assert trial._find_shown(known_search(one), one) == {"cogging"}


@pytest.mark.parametrize(("whole", "named"), [(600.0, True), (7e6, False)])
def test_what_is_dwarfed_by_another_effect_may_be_what_its_form_leaves(
    monkeypatch: pytest.MonkeyPatch, whole: float, named: bool
) -> None:
    """A hundred more of a gain of seven million, of which no law holds to a hundredth."""
    baseline = known_baseline()
    both = known_fit(baseline, ["cogging", "spring_torque"], whole, coverage=0.99)
    one = known_fit(baseline, ["cogging"], whole - 100.0, coverage=0.99)
    found = _try(monkeypatch, both, one, shares=Repetitions(10, {("cogging", "spring_torque"): 10}))
    assert found.chosen is (both if named else one)
