"""Samples beside reversals are all off the same way: a law that does not need them is not fitted to them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fricomp
from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.recording import Recording, write_recording

INERTIA, COULOMB, VISCOUS = 0.02, 0.3, 0.1
RATE, STEPS = 300.0, 16
COUNT = 2.4e-5


def _swing(seed: int, seconds: float) -> Recording:
    """A joint under a PD loop, integrated in small steps between rows, with stiction where it comes to rest."""
    rng, h = np.random.default_rng(seed), 1.0 / RATE / STEPS
    rates, sizes = 2.0 * np.pi * np.array([0.3, 0.83]), np.array([0.6, 0.25])
    t = np.asarray(h * np.arange(int(seconds * RATE) * STEPS), dtype=np.float64)
    angles = rates[:, None] * t + rng.uniform(0.0, 2.0 * np.pi, 2)[:, None]
    reference, wanted = sizes @ np.sin(angles), (sizes * rates) @ np.cos(angles)
    q, v, rows = float(reference[0]), float(wanted[0]), []
    for r, w in zip(reference.tolist(), wanted.tolist(), strict=True):
        torque = 12.0 * (r - q) + 0.5 * (w - v)
        rows.append((q, torque))
        free = v + h * (torque - VISCOUS * v) / INERTIA
        after = max(abs(free) - h * COULOMB / INERTIA, 0.0) * (1.0 if free > 0.0 else -1.0)
        q, v = q + 0.5 * h * (v + after), after
    position, torque = np.array(rows)[::STEPS].T
    return Recording(t[::STEPS], np.round(position / COUNT) * COUNT, torque + 0.002 * rng.normal(size=torque.size))


@pytest.mark.parametrize(("seed", "stamps"), [(1, "even"), (4, "even"), (4, "ms")])
def test_long_swings_give_coulomb_and_viscous_friction_within_their_interval(
    seed: int, stamps: str, tmp_path: Path
) -> None:
    log = _swing(seed, 40.0)
    if stamps == "ms":
        log = log.with_channels(time=np.round(log.time, 3))
    write_recording(log, tmp_path / "log.csv")
    result = fricomp.identify(tmp_path / "log.csv", law="coulomb_viscous").result
    assert result.status == "converged"
    for name, truth in (("coulomb.coulomb_torque", COULOMB), ("viscous.viscous_coefficient", VISCOUS)):
        assert result.interval(name, 0.99).holds(truth), (name, result.parameters[name])


def test_strokes_that_are_too_short_keep_their_samples() -> None:
    log = _swing(1, 6.0)
    samples = sample_joint(log, choose_settings(log))
    all_rows, apart = (samples.sliding(0.01, bends=bends) for bends in (True, False))
    assert np.count_nonzero(apart) >= 200
    assert np.all(all_rows[apart])
