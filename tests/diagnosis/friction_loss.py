"""A pendulum with MuJoCo's own friction loss under a PD loop, for the tests of friction that creeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from fricomp.recording import Recording

__all__ = ["STICKING", "FrictionLoss", "recording", "reference_of", "simulated"]

_STEP = 2.5e-4  # [s] of the simulation and of the loop
_GAINS = (120.0, 6.0)  # [N·m/rad], [N·m·s/rad]
_FILTER = 0.12  # share by which the loop's velocity follows that of the encoder in a step
_NOISE = 0.06  # [N·m]
_ORDER = 12.0  # [1/rad] of the cogging
_XML = """<mujoco><option timestep="{step}" integrator="implicitfast"/><worldbody><body pos="0 0 1">
<joint type="hinge" axis="0 1 0" armature="0.05" damping="0.6" frictionloss="{level}" solreffriction="{time} 1"
 solimpfriction="{impedance}"/><inertial pos="0 0 -0.2" mass="{mass}" diaginertia="0.03 0.03 0.027"/></body></worldbody>
</mujoco>"""
_USUAL = "0.9 0.95 0.001 0.5 2"

STICKING = "0.9999 0.9999 0.001 0.5 2"
"""Impedance with which a joint at rest hardly creeps."""


@dataclass(frozen=True)
class FrictionLoss:
    """Truth.

    Attributes:
        level: Friction loss [N·m].
        time: Time constant of its constraint [s].
        impedance: `solimpfriction` of the joint.
        mass: Of the pendulum [kg].
        cogging: Amplitude of a torque ripple of order 12 [N·m].
        load_friction: Rise of the friction loss with the gravity torque [1].
        drag: Of a friction that grows with the square of the speed [N·m·s²/rad²].
    """

    level: float = 1.5
    time: float = 0.02
    impedance: str = _USUAL
    mass: float = 2.0
    cogging: float = 0.0
    load_friction: float = 0.0
    drag: float = 0.0

    @property
    def gravity(self) -> float:
        """Its amplitude [N·m]."""
        return 9.81 * 0.2 * self.mass

    @property
    def inertia(self) -> float:
        """About the joint [kg·m²]."""
        return 0.05 + 0.03 + self.mass * 0.2**2

    @property
    def rate(self) -> float:
        """Rate at which the constraint brakes [1/s]."""
        return 2.0 / (float(self.impedance.split()[1]) * self.time)

    @property
    def creep_velocity(self) -> float:
        """Velocity below which the friction is viscous [rad/s]: F = d (tau + b J v), so F (1 - d) = d J (w' + b v)."""
        d = float(self.impedance.split()[0])
        return self.level * (1.0 - d) / (d * self.rate * self.inertia)


def reference_of(kind: str, duration: float) -> np.ndarray:
    """Reference position [rad], with rests ("rests"), in sines ("multisine") or ever faster ("sweep"). Shape (n,)."""
    t = np.arange(round(duration / _STEP), dtype=np.float64) * _STEP
    if kind == "multisine":
        return 0.35 * np.asarray(sum(np.sin(2.0 * np.pi * f * t) / (1.0 + f) for f in (0.11, 0.23, 0.47, 0.83)))
    if kind == "sweep":
        return 0.5 * np.sin(2.0 * np.pi * (0.1 * t + 0.5 * 0.9 / duration * t**2))
    rng, knots, place = np.random.default_rng(3), [(0.0, 0.0)], 0.0
    while knots[-1][0] < duration:
        place, took = float(rng.uniform(-0.8, 0.8)), float(rng.uniform(0.5, 1.5))
        knots += [(knots[-1][0] + took, place), (knots[-1][0] + took + float(rng.uniform(0.1, 0.6)), place)]
    times, places = np.array(knots).T
    window = np.hanning(1 + round(0.25 / _STEP))
    return np.convolve(np.interp(t, times, places), window / window.sum(), "same")


def recording(
    truth: FrictionLoss, kind: str, *, duration: float = 30.0, rate: int = 1000, seed: int = 0, bits: int = 18
) -> Recording:
    """What sensors record of the joint at `rate` [1/s], its encoder having `bits` in a turn."""
    time, position, torque = _moved(truth, kind, duration, rate, 2.0 * np.pi / 2**bits)
    noise = _NOISE * np.random.default_rng(seed).standard_normal(position.size)
    return Recording(time, position, torque + noise)


def simulated(truth: FrictionLoss, kind: str, *, duration: float = 30.0, rate: int = 1000) -> Recording:
    """What a simulator writes of the joint at `rate` [1/s]: without sensors, in the loop and in the file."""
    return Recording(*_moved(truth, kind, duration, rate, 0.0))


def _moved(
    truth: FrictionLoss, kind: str, duration: float, rate: int, resolution: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time [s], position [rad] and torque [N·m] under a loop whose encoder has this resolution. Shapes (n,)."""
    model: Any = mujoco.MjModel.from_xml_string(
        _XML.format(step=_STEP, level=truth.level, time=truth.time, impedance=truth.impedance, mass=truth.mass)
    )
    data: Any = mujoco.MjData(model)
    wanted = reference_of(kind, duration)
    speeds, shown = np.gradient(wanted, _STEP), np.empty((2, wanted.size))
    data.qpos[0], seen, before = wanted[0], 0.0, wanted[0]
    for k in range(wanted.size):
        position = np.round(data.qpos[0] / resolution) * resolution if resolution > 0.0 else data.qpos[0]
        seen, before = seen + _FILTER * ((position - before) / _STEP - seen), position
        torque = _GAINS[0] * (wanted[k] - position) + _GAINS[1] * (speeds[k] - seen)
        shown[:, k] = position, torque
        model.dof_frictionloss[0] = truth.level + truth.load_friction * truth.gravity * abs(np.sin(data.qpos[0]))
        drag = truth.drag * data.qvel[0] * abs(data.qvel[0])
        data.qfrc_applied[0] = torque + truth.cogging * np.sin(_ORDER * data.qpos[0]) - drag
        mujoco.mj_step(model, data)
    each = round(1.0 / (rate * _STEP))
    position, torque = shown[:, ::each]
    return np.arange(position.size) / rate, position, torque
