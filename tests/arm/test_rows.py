"""The rows that are compared: motion and torque pass the same filters, also where a recording begins and ends."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.examination import match_recordings
from fricomp.arm.rows import build_rows

from .moving_arm import record_arm, write_arm


@pytest.mark.parametrize("cutoff", [1.25, 5.0])
def test_a_log_that_begins_and_ends_in_full_swing_is_right_up_to_its_first_and_last_row(
    tmp_path: Path, cutoff: float
) -> None:
    """Turned over at its ends, the arm brakes where it went on; the row one period from there held a tenth of that."""
    simulation = write_arm(tmp_path, rotors=(2.0, 1.0, 0.5))
    arm, recording = match_recordings(record_arm(simulation, duration=12.0, noise=0.0), simulation)
    rows = build_rows(arm, recording, cutoff)
    acceleration = rows.compare(lambda _, __, a: a)
    friction = rows.compare(lambda _, v, __: np.array([1.2, 0.8, 0.3]) * np.sign(v) + np.array([0.6, 0.4, 0.1]) * v)
    left = rows.torque - rows.links @ arm.inertia.ravel() - arm.armature * acceleration - friction
    assert np.max(np.abs(left[[0, 1, -2, -1]])) < 0.03  # of torques of several N·m; 1.2 after one period
