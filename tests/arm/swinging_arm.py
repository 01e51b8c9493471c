"""The arm of three joints whose elbow swings on a gear that gives way, going from stop to stop."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

from .moving_arm import JOINTS

_STEP, _ROWS = 1e-3, 4
"""[s] of the simulation, and its steps from one row to the next."""

_ELBOW, _RATIO = 1, 0.03
"""Damping ratio of the swing: gears have some hundredths."""

_LEVELS, _SLOPES, _NOISE = (1.2, 0.8, 0.3), (0.6, 0.4, 0.1), (0.03, 0.03, 0.003)


def record_swinging(simulation: Path, stiffness: float, *, seed: int = 0, duration: float = 30.0) -> list[Recording]:
    """Recordings with the positions of the motors.

    Args:
        simulation: Of the arm.
        stiffness: Of the elbow's gear [N·m/rad].
        seed: Of motion and noise.
        duration: [s].
    """
    rng, model = np.random.default_rng(seed), mujoco.MjModel.from_xml_path(str(simulation))
    data: Any = mujoco.MjData(model)
    time = np.arange(0.0, duration, _STEP)
    q, v, a = _go_from_stop_to_stop(rng, time)
    mass, torques, twist, rate = np.zeros((model.nv, model.nv)), np.empty_like(q), 0.0, 0.0
    for k in range(len(time)):
        data.qpos[:3], data.qvel[:3], data.qacc[:3] = q[k], v[k], a[k]
        data.qpos[_ELBOW] -= twist
        data.qvel[_ELBOW] -= rate
        mujoco.mj_inverse(model, data)
        mujoco.mj_fullM(model, data, mass)
        own = mass[_ELBOW, _ELBOW]
        damping = 2.0 * _RATIO * np.sqrt(stiffness * own)
        twisting = (data.qfrc_inverse[_ELBOW] - stiffness * twist - damping * rate) / own
        torques[k] = data.qfrc_inverse[:3] - mass[:3, _ELBOW] * twisting
        rate += _STEP * twisting
        twist += _STEP * rate
    recordings = []
    for j, name in enumerate(JOINTS):
        torque = torques[:, j] + _LEVELS[j] * np.sign(v[:, j]) + _SLOPES[j] * v[:, j]
        torque += _NOISE[j] * rng.normal(size=time.size)
        position = np.round(q[:, j] * 2**17 / (2.0 * np.pi)) * 2.0 * np.pi / 2**17
        channels = {"time": time[::_ROWS], "position": position[::_ROWS], "torque": torque[::_ROWS]}
        recordings.append(Recording(**channels, metadata=RecordingMetadata(joint=name)))
    return recordings


def _go_from_stop_to_stop(rng: np.random.Generator, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity and acceleration of least jerk between drawn postures. Shapes (n, 3)."""
    q, v, a = (np.zeros((time.size, 3)) for _ in range(3))
    begin, here = 0.0, np.zeros(3)
    while begin < time[-1]:
        there, takes = rng.uniform(-0.9, 0.9, 3), rng.uniform(0.7, 1.5)
        on = time >= begin
        s = np.minimum((time[on] - begin) / takes, 1.0)[:, None]
        q[on] = here + (there - here) * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        v[on] = (there - here) * 30.0 * s**2 * (1.0 - s) ** 2 / takes
        a[on] = (there - here) * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / takes**2
        begin, here = begin + takes + rng.uniform(0.2, 0.5), there
    return q, v, a
