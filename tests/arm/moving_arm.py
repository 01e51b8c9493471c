"""An arm of three joints whose torques come from MuJoCo's inverse dynamics, with friction written out here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

JOINTS = ("shoulder", "elbow", "wrist")
MASSES = (4.0, 2.5, 1.2)
_MJCF = """<mujoco><compiler angle="radian"/><worldbody>
<body name="upper"><inertial pos="0 0 0.15" mass="{0}" diaginertia="0.04 0.04 0.01"/>
<joint name="shoulder" axis="0 1 0" armature="{3}"/>
<body name="lower" pos="0 0 0.35"><inertial pos="0.02 0 0.12" mass="{1}" diaginertia="0.02 0.02 0.005"/>
<joint name="elbow" axis="0 1 0" armature="{4}"/>
<body name="hand" pos="0 0 0.3"><inertial pos="0 0.01 0.06" mass="{2}" diaginertia="0.005 0.005 0.003"/>
<joint name="wrist" axis="1 0 0" armature="{5}"/>
<body name="finger" pos="0 0 0.1"><inertial pos="0 0 0" mass="0.05" diaginertia="1e-5 1e-5 1e-5"/>
<joint name="grip" type="slide" axis="1 0 0" range="0 0.04"/></body></body></body></body></worldbody></mujoco>"""
_LEVELS, _SLOPES = (1.2, 0.8, 0.3), (0.6, 0.4, 0.1)

Friction = Callable[[int, FloatArray, FloatArray, FloatArray], FloatArray]
"""Torque of a joint beside Coulomb and viscous friction: its number, position, velocity and transmitted torque."""

Bend = Callable[[int, FloatArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""Position that a joint records, and velocity that its friction sees: of its number, time, position and transmitted
torque."""


def bend_gear(joint: int, stiffness: float, side: str) -> Bend:
    """A gear of one joint that gives way, with the encoder on the side of its motor or of its link."""

    def bend(number: int, time: FloatArray, position: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        motor = position + load / stiffness if number == joint else position
        return motor if side == "motor" else position, np.gradient(motor, time)

    return bend


def write_arm(
    folder: Path,
    masses: tuple[float, float, float] = MASSES,
    rotors: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Path:
    path = folder / f"arm-{'-'.join(map(str, (*masses, *rotors)))}.xml"
    path.write_text(_MJCF.format(*masses, *rotors))
    return path


def record_arm(
    simulation: Path,
    more: Friction | None = None,
    *,
    seed: int = 0,
    duration: float = 40.0,
    rate: float = 250.0,
    noise: float = 0.03,
    delay: float = 0.0,
    bend: Bend | None = None,
    joints: Sequence[str] = JOINTS,
    size: float = 1.0,
) -> list[Recording]:
    """Recordings of all joints on a Fourier motion, with encoders of 17 bits and noise of the torque [N·m]."""
    rng, time = np.random.default_rng(seed), np.arange(0.0, duration, 1.0 / rate)
    q, v, a = (size * one for one in _move(rng, time))
    rigid = _invert(mujoco.MjModel.from_xml_path(str(simulation)), q, v, a)
    recordings = []
    for j, name in enumerate(joints):
        seen, turned = (q[:, j], v[:, j]) if bend is None else bend(j, time, q[:, j], rigid[:, j])
        friction = _LEVELS[j] * np.sign(turned) + _SLOPES[j] * turned
        if more is not None:
            friction = friction + more(j, q[:, j], v[:, j], rigid[:, j])
        torque = np.interp(time - delay, time, rigid[:, j] + friction) + noise * rng.normal(size=time.size)
        position = np.round(seen * 2**17 / (2.0 * np.pi)) * 2.0 * np.pi / 2**17
        recordings.append(
            Recording(time=time, position=position, torque=torque, metadata=RecordingMetadata(joint=name))
        )
    return recordings


def _move(rng: np.random.Generator, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    q, v, a = (np.zeros((time.size, 3)) for _ in range(3))
    for j in range(3):
        for harmonic in range(1, 8):
            w = 2.0 * np.pi * 0.1 * harmonic
            size, phase = rng.normal() * 0.8 / harmonic, rng.uniform(0.0, 2.0 * np.pi)
            q[:, j] += size * np.sin(w * time + phase)
            v[:, j] += size * w * np.cos(w * time + phase)
            a[:, j] -= size * w**2 * np.sin(w * time + phase)
    return q, v, a


def _invert(model: Any, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    data: Any = mujoco.MjData(model)
    torques = np.empty_like(q)
    for k in range(len(q)):
        data.qpos[:3], data.qvel[:3], data.qacc[:3] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        torques[k] = data.qfrc_inverse[:3]
    return torques
