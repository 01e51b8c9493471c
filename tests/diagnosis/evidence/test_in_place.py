"""What a moved inertia or gravity explains, an effect may explain that leaves the simulation as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint, diagnose
from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence import in_place as module
from fricomp.diagnosis.evidence.in_place import _Question, prefer_in_place
from fricomp.diagnosis.search.simulated_body import move_to

from ..known import known, known_baseline, known_case
from ..toy_joint import ToyJoint, recording

_BASE = known_baseline()
_GIVEN = RigidJoint(ToyJoint().inertia, (1.773, 5.732), 0.0, 0.0, 0.0, True)  # gravity of the toy joint


def _question(cost: float, left: float = 0.0) -> _Question:
    moved = known((), -20.0, np.zeros(1), left=left)
    return _Question(moved, known((), 0.0, np.array([np.sqrt(cost)])), _BASE.box)


@pytest.mark.parametrize(
    ("gain", "cost", "left", "as_well"),
    [
        (5.0, 300.0, 0.0, True),
        (-31.0, 300.0, 0.0, True),
        (-33.0, 300.0, 0.0, False),  # lacks more than 12
        (-45.0, 2000.0, 0.0, False),  # moved parameters leave nothing: a law of another form is another law
        (-45.0, 2000.0, 30.0, True),  # 3 % of what is to be explained, and less than they leave themselves
        (-45.0, 300.0, 30.0, False),
    ],
)
def test_an_effect_explains_as_much_within_what_its_form_may_lack(
    gain: float, cost: float, left: float, *, as_well: bool
) -> None:
    assert _question(cost, left).does_as_well(known(("cogging",), gain), 0.0) is as_well


@pytest.mark.parametrize(
    ("gain", "takes_place", "told"),
    [
        (60.0, True, ("cogging",)),
        (0.0, False, ("cogging",)),  # no more than the moved parameters by the threshold
        (-60.0, False, ()),
    ],
)
def test_an_effect_takes_the_place_of_parameters_only_by_the_threshold(
    gain: float, *, takes_place: bool, told: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    question = _question(300.0)
    monkeypatch.setattr(module, "_ask", lambda _: question)
    monkeypatch.setattr(module, "_list_tried", lambda *_: [])
    monkeypatch.setattr(module, "fit_from", lambda *_: [known(("cogging",), gain)])
    monkeypatch.setattr(module, "_judge_standing", lambda _, one, given: replace(one, before=given))
    case = prefer_in_place(known_case(_BASE))
    assert case.instead == told
    best = case.found.best
    assert (best is not None) is takes_place
    assert best is None or best.before is question.given.fit


def test_gravity_that_moves_leaves_the_mean_torque() -> None:
    position = np.linspace(-0.2, 0.3, 101)
    theta = np.array([0.1, 13.0, 21.0, -10.0, 5.0])
    body = np.array([0.0, 3.0, 19.0])
    (context,) = _BASE.structure.contexts
    moved = move_to(body, theta, [replace(context, position=position)])

    def mean(one: np.ndarray) -> float:
        return float(np.mean(one[1] * np.cos(position) + one[2] * np.sin(position)) + one[3])

    assert mean(moved) == pytest.approx(mean(theta))
    assert moved[:3] == pytest.approx(body)
    assert moved[4] == theta[4]


def test_a_lag_too_short_to_be_named_is_faint_and_no_other_is() -> None:
    lag, contexts = EFFECTS["frictional_lag"], list(_BASE.structure.contexts)
    assert lag.is_faint({"lag": 1e-3}, contexts)
    assert lag.refuse({"lag": 1e-3}, contexts)
    assert not lag.is_faint({"lag": 3e-3}, contexts)
    assert lag.refuse({"lag": 3e-3}, contexts) is None
    assert not EFFECTS["cogging"].is_faint({}, contexts)


@pytest.mark.slow
def test_gravity_that_a_faint_spring_bends_is_not_told_from_the_spring() -> None:
    faint = ToyJoint(spring=(0.08, 0.15, 0.0))
    (effect,) = diagnose(recording(faint, "fourier", 20.0, every=2), _GIVEN).effects
    assert effect.name == "payload_error"
    assert "spring_torque" in effect.indistinguishable_from
