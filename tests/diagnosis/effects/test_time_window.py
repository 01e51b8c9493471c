"""Stretches of time in which a torque from outside acts: what speaks for time and against the joint's state."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.effects.time_window import _find_near


@pytest.mark.parametrize(
    ("pulls", "expected"),
    [
        ([1.0, 1.0, 0.0], [False, False]),
        ([1.0, -1.0, 0.0], [True, True]),
        ([1.0, 0.0, 0.0], [True]),
    ],
    ids=["both pull alike", "both pull apart", "one stays quiet"],
)
def test_a_state_explains_a_pull_only_where_it_pulls_so_each_time(pulls: list[float], expected: list[bool]) -> None:
    """A push in one of two like strokes had bent the base into both, and nothing was called a push for it."""
    states = np.array([[0.0, 0.0], [1e-3, 0.0], [5.0, 5.0]])
    np.testing.assert_array_equal(_find_near(states, np.array(pulls)), expected)
