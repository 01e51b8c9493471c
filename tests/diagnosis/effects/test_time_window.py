"""Stretches of time in which a torque from outside acts: what speaks for time and against the joint's state."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.effects.time_window import _are_pairs_near, _find_near


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


@pytest.mark.parametrize(("slow", "expected"), [(False, True), (True, False)])
def test_a_motion_comes_to_pairs_of_states_again_and_to_no_three_of_them(slow: bool, expected: bool) -> None:
    """A push of 1.3 s in 20 s of sines was unknown, since no state of three numbers came twice."""
    time = np.linspace(0.0, 20.0, 2000)
    position = sum(np.sin(rate * time + phase) for rate, phase in ((1.0, 0.0), (2.3, 1.0), (3.9, 2.0)))
    velocity = np.gradient(position, time)
    states = np.stack([position, velocity, np.gradient(velocity, time)], axis=1)
    pulls = np.where((time > 6.0) & (time < 7.0), 1.0, 0.0)
    if slow:  # and stays where it is at no other time
        states[pulls > 0.0, 0] += 9.0
    states /= np.quantile(states, 0.99, axis=0) - np.quantile(states, 0.01, axis=0)
    assert _are_pairs_near(states, pulls) is expected
    assert np.mean(_find_near(states, pulls)) < 0.4
