"""Noise of encoders: what torque it looks like, and up to which frequency a motion stands out of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.coordinates import ArmModel
from fricomp.arm.encoder_noise import clear_position, compute_noise_torque
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.fit import fit_arm
from fricomp.arm.prior import ArmPrior
from fricomp.arm.rows import build_rows

from .moving_arm import record_arm, write_arm


@pytest.mark.parametrize("rate", [100.0, 500.0])
def test_the_torque_that_noise_of_encoders_looks_like_is_told(tmp_path: Path, rate: float) -> None:
    """Of two recordings that differ by noise of the positions alone, links ask for torques that differ by so much."""
    simulation, size, rng = write_arm(tmp_path), 3e-4, np.random.default_rng(0)
    quiet = record_arm(simulation, duration=10.0, rate=rate)
    loud = [
        one.with_channels(position=np.asarray(one.position) + size * rng.normal(size=len(one.time))) for one in quiet
    ]
    rows = []
    for series in (quiet, loud):
        arm, recording = match_recordings(series, simulation)
        rows.append(build_rows(arm, recording, 5.0))
    equations = build_equations(arm, rows[0], rows[0].links @ arm.inertia.ravel(), plain=True)
    fit = fit_arm(arm, equations, ArmModel.build_plain(3), ArmPrior())
    before, after = (one.links @ fit.inertia.ravel() for one in rows)
    expected = np.sqrt(np.mean((after - before) ** 2, axis=0))
    assert compute_noise_torque(rows[1], fit)[:2] == pytest.approx(expected[:2], rel=0.25)


def test_a_motion_is_cleared_of_noise_alone() -> None:
    rng, time = np.random.default_rng(0), np.arange(0.0, 30.0, 0.002)
    motion = np.sin(2.0 * np.pi * 0.4 * time) + 0.01 * np.sin(2.0 * np.pi * 3.0 * time)
    noise = 1e-4 * rng.normal(size=time.size)
    cleared = clear_position(motion + noise, 0.002)
    inner = slice(500, -500)
    assert np.std((cleared - motion)[inner]) < 0.3 * np.std(noise)
    assert clear_position(motion, 0.002)[inner] == pytest.approx(motion[inner], abs=1e-6)
