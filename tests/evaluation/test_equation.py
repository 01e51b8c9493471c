"""States of terms along a motion: the same for all samples at once as one sample after the other."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.evaluation.equation import _find_line, _follow_by_formula, _follow_states
from fricomp.laws import Dahl, DwellStiction, DynamicTerm, LaggedStribeck, LuGre, OperatingPoint, StribeckCurve

_FORWARD, _REVERSE = StribeckCurve(0.4, 0.6, 0.05, 0.1), StribeckCurve(0.5, 0.7, 0.08, 0.12)
_BRISTLE = LuGre(_FORWARD, _REVERSE, 600.0, 1.5)


def _make_motion() -> OperatingPoint:
    """A motion with reversals and a rest."""
    velocity = np.cumsum(np.random.default_rng(3).standard_normal(4000)) * 0.02
    velocity[1000:1300] = 0.0
    position = np.cumsum(velocity) * 2e-3
    return OperatingPoint(velocity, position, np.gradient(velocity, 2e-3), np.sin(position), None, None)


@pytest.mark.parametrize(
    "term",
    [_BRISTLE, Dahl(0.4, 500.0), DwellStiction(0.4, 0.3, 5e-3, 0.4), LaggedStribeck(_FORWARD, _REVERSE, lag=8e-3)],
    ids=lambda term: term.name,
)
def test_states_worked_out_at_once_are_those_of_the_formula(term: DynamicTerm) -> None:
    point = _make_motion()
    at_once, one_by_one = _follow_states(term, point, 2e-3), _follow_by_formula(term, point, 2e-3)
    assert float(np.max(np.abs(one_by_one))) > 0.0
    np.testing.assert_allclose(at_once, one_by_one, rtol=0.0, atol=1e-12 * float(np.max(np.abs(one_by_one))))


def test_a_bristle_at_a_given_velocity_is_a_line_in_its_state() -> None:
    assert _find_line(_BRISTLE, _make_motion(), 2e-3) is not None
