"""An explanation that leaves the simulation as it is comes before one that moves its parameters and fits as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from fricomp.diagnosis.evidence import agreement, findings
from fricomp.diagnosis.evidence.agreement import prefer_agreeing
from fricomp.diagnosis.evidence.alias import list_aliases
from fricomp.diagnosis.evidence.case import Case
from fricomp.diagnosis.evidence.comparison import PLAIN, Comparison, Shift, Tolerances
from fricomp.diagnosis.evidence.refitted import RefittedJoint
from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.joint.solver import Box
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline
from fricomp.diagnosis.search.search import SearchResult
from fricomp.diagnosis.search.simulated_body import hold

from ..known import known, known_baseline, known_search

_BASE = known_baseline()


def _leave(names: Sequence[str], gain: float, rows: NDArray[np.bool_] | None = None, **more: Any) -> Explanation:
    """An explanation that leaves less the more it gains: evenly in these rows, or in all of them."""
    at = np.ones(_BASE.fit.residual.size, dtype=bool) if rows is None else rows
    return known(names, gain, np.sqrt((2000.0 - gain) / np.sum(at)) * at, **more)


_LOAD, _SPLIT = _leave(["load_coulomb"], 1000.0), _leave(["load_quadratic"], 990.0)


def test_of_two_that_fit_as_well_the_one_that_agrees_is_taken() -> None:
    found = prefer_agreeing(_BASE, known_search(_LOAD, _SPLIT), None, lambda one, _: one is _LOAD)
    assert found.best is _SPLIT
    assert set(found.explanations) == {_LOAD, _SPLIT}


def test_one_that_agrees_as_nearly_as_a_law_can_comes_before_one_that_does_not() -> None:
    def differs(one: Explanation, tolerances: Tolerances) -> bool:
        return one is _LOAD or tolerances is PLAIN

    assert prefer_agreeing(_BASE, known_search(_LOAD, _SPLIT), None, differs).best is _SPLIT
    assert prefer_agreeing(_BASE, known_search(_SPLIT, _LOAD), None, differs).best is _SPLIT


@pytest.mark.parametrize(
    ("rival", "differing"),
    [
        (_SPLIT, {"load_coulomb", "load_quadratic"}),  # both move the simulation
        (_SPLIT, set()),  # neither does
        (_leave(["load_quadratic"], 900.0), {"load_coulomb"}),  # fits worse
        (_leave(["load_quadratic"], 990.0, refused="static friction would fall"), {"load_coulomb"}),
        (_leave(["load_quadratic", "cogging"], 999.0), {"load_coulomb"}),  # has more effects
    ],
)
def test_else_the_best_one_stays(rival: Explanation, differing: set[str]) -> None:
    found = prefer_agreeing(_BASE, known_search(_LOAD, rival), None, lambda one, _: one.names[0] in differing)
    assert found.best is _LOAD


@pytest.mark.parametrize(("effect", "taken"), [("load_quadratic", True), ("load_stribeck", False)])
def test_what_fits_worse_about_rest_alone_fits_as_well_unless_its_effect_shows_there(effect: str, taken: bool) -> None:
    """A friction that jumps when the joint turns leaves more there than one that does not, as the bristle has it."""
    rest = ~_BASE.sliding
    assert 0 < np.sum(rest) < rest.size
    best = known(["load_coulomb"], 1e4, np.ones(rest.size))
    worse = known([effect], best.gain - 0.4 * float(np.sum(rest)), np.sqrt(1.0 + 0.4 * rest))
    found = prefer_agreeing(_BASE, known_search(best, worse), None, lambda one, _: one is best)
    assert (found.best is worse) == taken


_JOINT = RigidJoint(2.0, (3.0, 4.0), 0.0, 0.0, 0.0, True)


def test_what_is_held_at_the_simulation_is_weighed_at_its_minimum(monkeypatch: pytest.MonkeyPatch) -> None:
    """A narrow valley ends far from where a fit from other parameters has come to."""
    short, other = _leave(["load_quadratic"], 10.0), _leave(["load_quadratic"], -5.0)
    monkeypatch.setattr(agreement, "_fit_held", lambda *_: [other, short])
    monkeypatch.setattr(agreement, "polish", lambda _, some, **__: [_SPLIT if one is short else one for one in some])
    assert prefer_agreeing(_BASE, known_search(_LOAD), _JOINT, lambda one, _: one is _LOAD).best is _SPLIT


@pytest.mark.parametrize(
    ("straight", "left"),
    [
        (_leave(["load_quadratic"], 995.0), ("load_quadratic",)),  # fits with the simulation's parameters as well
        (_leave(["load_quadratic"], 900.0), ()),
        (_leave(["load_quadratic"], 995.0, refused="friction would fall"), ()),
    ],
)
def test_a_rival_is_one_only_if_it_fits_the_simulation(
    straight: Explanation, left: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(agreement, "_fit_held", lambda *_: [straight])
    found = prefer_agreeing(_BASE, known_search(_LOAD, _SPLIT), _JOINT, lambda one, _: one is _SPLIT)
    assert found.best is _LOAD
    assert list_aliases(found, "load_coulomb") == left
    assert [e.refused for e in found.explanations if e.gain == _SPLIT.gain] == [agreement._BENT]


def test_where_the_best_one_moves_the_simulation_its_rivals_may_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agreement, "_fit_held", lambda *_: [])
    found = prefer_agreeing(_BASE, known_search(_LOAD, _SPLIT), _JOINT, lambda one, _: True)
    assert list_aliases(found, "load_coulomb") == ("load_quadratic",)


def test_the_simulation_is_held_and_nothing_else() -> None:
    box = Box(-np.ones(17), np.ones(17), np.ones(17), np.full(17, 0.5), np.eye(17), np.ones(17))
    held = hold(box, _JOINT)
    np.testing.assert_allclose(held.centre[:3], [np.log(2.0), 3.0, 4.0])
    np.testing.assert_allclose(np.sqrt(np.diag(held.precision)[:3]), [500.0, 100.0, 100.0])
    np.testing.assert_array_equal(held.centre[3:], box.centre[3:])
    np.testing.assert_array_equal(held.precision[3:], box.precision[3:])


@dataclass(frozen=True)
class _Case:
    """What the choice asks of a case."""

    found: SearchResult
    baseline: Baseline = _BASE
    rigid: RigidJoint | None = None


def test_friction_that_is_uneven_does_not_count_as_moving_the_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """A simulation has one friction loss for both directions: next to any joint differs from that."""

    def compare(_: object, one: Explanation, __: Tolerances) -> Comparison:
        moved = ["direction_asymmetry", *(["payload_error"] if one is _LOAD else [])]
        return Comparison(tuple(Shift(name, {}, "") for name in moved))

    monkeypatch.setattr(findings, "compare_given", compare)
    monkeypatch.setattr(RefittedJoint, "refit", lambda _, one: one)
    monkeypatch.setattr(findings, "prefer_in_place", lambda case: case)
    case = findings.prefer_simulation(cast(Case, _Case(known_search(_LOAD, _SPLIT))))
    assert case.found.best is _SPLIT
