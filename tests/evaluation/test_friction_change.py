"""Friction that is another one at the end of a recording."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.evaluation import find_friction_change


@pytest.mark.parametrize("rise", [0.0, 0.02, 0.3, -0.3])
def test_the_change_from_the_first_to_the_last_quarter_is_found(rise: float) -> None:
    time = np.arange(0.0, 200.0, 0.02)
    velocity = np.cos(1.7 * time)
    left = (rise * (time / 200.0 - 0.5)) * np.sign(velocity) + 0.05 * np.random.default_rng(2).standard_normal(
        time.size
    )
    torque = left + np.sign(velocity) + 3.0 * np.sin(1.7 * time)
    change = find_friction_change(time, left, torque, velocity)
    if abs(rise) < 0.05:
        assert change is None
        return
    assert change is not None
    assert change.torque == pytest.approx(0.75 * rise, abs=0.01)
    assert change.part == pytest.approx(0.75 * rise, abs=0.02)
    assert ("rises" if rise > 0.0 else "falls") in change.describe("N·m")


def test_a_short_recording_says_nothing_of_it() -> None:
    rows = np.linspace(0.0, 1.0, 100)
    assert find_friction_change(rows, rows, rows, rows + 1.0) is None
