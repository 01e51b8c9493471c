"""Positions that were taken for rad and are degrees, as the simulation tells: gravity goes round with each turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording import Recording

from ..arm_recording import join_joints
from ..rigid.simulated_arm import SimulatedArm
from .frames import explains_better, measure_frames

_TRAVEL = 2.0 * np.pi
"""[rad] or degrees that a joint covers at least where it is asked."""

_SAME = 0.2
"""Relative error within which a velocity is the rate of a position."""


def are_degrees(arm: SimulatedArm, recordings: Sequence[Recording]) -> bool:
    """Whether the simulation explains the torques only where the positions of all joints that turn are degrees.

    Args:
        arm: The simulation.
        recordings: One of each joint, in its order.
    """
    turning = [one for one, rotary in zip(recordings, arm.rotary, strict=True) if rotary]
    if not any(float(np.ptp(one.position)) > _TRAVEL for one in turning):
        return False
    try:
        as_read, in_degrees = (
            measure_frames(arm, join_joints(each)) for each in (recordings, take_radians(arm, recordings))
        )
    except RecordingError:  # too short, which is told where they are joined
        return False
    return explains_better(in_degrees, as_read)


def take_radians(arm: SimulatedArm, recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings with positions that were degrees in rad, and velocities where they are the rates of them."""
    pairs = zip(recordings, arm.rotary, strict=True)
    return [_take_radians(one) if rotary else one for one, rotary in pairs]


def _take_radians(recording: Recording) -> Recording:
    rate = np.gradient(np.asarray(recording.position), np.asarray(recording.time))
    channels = {"position": np.radians(recording.position)}
    for name in ("position_reference", "motor_position"):
        if getattr(recording, name) is not None:
            channels[name] = np.radians(getattr(recording, name))
    velocity = recording.velocity
    if velocity is not None and abs(float(velocity @ rate) / max(float(rate @ rate), 1e-300) - 1.0) < _SAME:
        channels["velocity"] = np.radians(velocity)
    return recording.with_channels(**channels)
