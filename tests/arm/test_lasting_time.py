"""Torques that look early, since the loops of the joints answer what moves them before their links do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.coordinates import ArmModel
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.prior import ArmPrior
from fricomp.arm.rows import build_rows
from fricomp.arm.timing.delay_correction import take_off_delay
from fricomp.recording import Recording

from .moving_arm import record_arm, write_arm

_RATE, _CUTOFF = 500.0, 20.0
_INERTIAS = (1.2, 0.4, 0.03)
_PUSHES = (2.4, 1.6, 0.6)
"""[N·m] by which each joint is pushed at random, which no model knows."""


def _push(recording: Recording, inertia: float, size: float) -> Recording:
    """The same of a joint whose loop of 40 rad/s answers random pushes."""
    push = size * np.random.default_rng(1).normal(size=recording.time.size)
    rate, damping, period = 40.0, 0.7, 1.0 / _RATE
    position, acceleration = np.zeros_like(push), np.zeros_like(push)
    at, speed = 0.0, 0.0
    for k, one in enumerate(push):
        acceleration[k] = one / inertia - 2.0 * damping * rate * speed - rate**2 * at
        speed += period * acceleration[k]
        at += period * speed
        position[k] = at
    return replace(
        recording, position=recording.position + position, torque=recording.torque + inertia * acceleration - push
    )


@pytest.mark.parametrize("early", [0.0, 0.008])
def test_torques_that_a_loop_makes_look_early_are_prompt_and_early_ones_are_early(tmp_path: Path, early: float) -> None:
    simulation = write_arm(tmp_path)
    recordings = record_arm(simulation, duration=15.0, rate=_RATE, delay=-early)
    if not early:
        recordings = [_push(one, *each) for one, *each in zip(recordings, _INERTIAS, _PUSHES, strict=True)]
    arm, recording = match_recordings(recordings, str(simulation))
    rows = build_rows(arm, recording, _CUTOFF)
    equations = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    plain = ArmModel.build_plain(len(arm.joints))
    _, _, delay, _ = take_off_delay(recording, rows, equations, plain, ArmPrior(), 0.0, arm)
    assert delay.value == pytest.approx(-early, abs=5e-4)
