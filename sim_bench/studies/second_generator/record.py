"""A recording of a joint: MuJoCo steps it, a PD loop moves it, an encoder and a noisy torque signal are kept."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import MissingExtraError
from fricomp.recording import Recording, RecordingMetadata

from .hidden import Hidden
from .joint import JOINT, write_mjcf
from .law import State
from .motion import PERIOD, Motion

try:
    import mujoco
except ImportError as error:  # pragma: no cover - depends on the installation
    raise MissingExtraError("mujoco", "sim") from error

RESOLUTION = 2.0 * np.pi / 2**18
"""Step of the encoder [rad]."""

NOISE = 0.04
"""Standard deviation of the white noise of the torque signal [N·m]."""

_SHARE = 0.3  # of the newest difference of the encoder in the velocity
FILTER_LAG = PERIOD * ((1.0 - _SHARE) / _SHARE + 0.5)
"""By which the velocity is late: the low pass, and half a sample of the difference [s]."""

_SUBSTEPS = 4  # of a sample
_GAINS = (600.0, 18.0)  # [N·m/rad], [N·m·s/rad]
_HEATING, _WARMING = 8.0, 15.0  # [K/W] of the motor's power in the long run, [s]
_AMBIENT = 25.0  # [°C]


@dataclass(frozen=True)
class Run:
    """What happened to a joint, and what its loop saw; arrays of shape (n_samples,).

    Attributes:
        motion: The loop's reference.
        position: True, at the sample [rad].
        velocity: True, at the sample [rad/s].
        acceleration: Mean until the next sample [rad/s²].
        command: Torque that the loop asks for until the next sample [N·m].
        encoder: [rad]
        filtered: Velocity that the loop makes of the encoder [rad/s].
        temperature: [°C]
    """

    motion: Motion
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    command: NDArray[np.float64]
    encoder: NDArray[np.float64]
    filtered: NDArray[np.float64]
    temperature: NDArray[np.float64]


class _Plant:
    """A joint in MuJoCo with a law that is written at every step."""

    def __init__(self, hidden: Hidden) -> None:
        self._step = PERIOD / _SUBSTEPS
        self._model: Any = mujoco.MjModel.from_xml_string(write_mjcf(hidden.parts, self._step))
        self._data: Any = mujoco.MjData(self._model)
        self._law = hidden.law()
        self._place = int(self._model.joint(JOINT).qposadr[0])
        self._dof = int(self._model.joint(JOINT).dofadr[0])
        self._bearer = int(self._model.joint(hidden.parts.bearer).dofadr[0])
        mujoco.mj_forward(self._model, self._data)

    @property
    def position(self) -> float:
        return float(self._data.qpos[self._place])

    @property
    def velocity(self) -> float:
        return float(self._data.qvel[self._dof])

    def advance(self, command: float, temperature: float) -> None:
        """One sample under a torque [N·m] at a temperature over that of the surroundings [K]."""
        model, data, dof = self._model, self._data, self._dof
        data.ctrl[0] = command
        for _ in range(_SUBSTEPS):
            load, velocity = float(data.qfrc_bias[dof]), float(data.qvel[self._bearer])
            state = State(data.time, self._step, self.position, velocity, load, command, temperature)
            acting = self._law(state)
            model.dof_frictionloss[self._bearer] = acting.level
            model.dof_damping[dof] = acting.viscous
            model.actuator_gainprm[0, 0] = acting.gain
            data.qfrc_applied[dof] = acting.torque
            mujoco.mj_step(model, data)


def simulate(hidden: Hidden, motion: Motion) -> Run:
    """Move a joint along a reference; the same always moves the same way."""
    plant, (amplitude, phase) = _Plant(hidden), hidden.eccentricity
    rows = np.empty((motion.time.size, 6))
    filtered, temperature, before = 0.0, 0.0, None
    for k in range(motion.time.size):
        position, velocity = plant.position, plant.velocity
        read = position + amplitude * np.sin(position + phase)
        encoder = float(np.round(read / RESOLUTION) * RESOLUTION)
        filtered += _SHARE * ((encoder - (encoder if before is None else before)) / PERIOD - filtered)
        before = encoder
        command = float(_GAINS[0] * (motion.position[k] - encoder) + _GAINS[1] * (motion.velocity[k] - filtered))
        rows[k] = position, velocity, command, encoder, filtered, _AMBIENT + temperature
        plant.advance(command, temperature)
        temperature += (_HEATING * abs(command * velocity) - temperature) * PERIOD / _WARMING
    position, velocity, command, encoder, filtered_velocity, warmth = np.ascontiguousarray(rows.T)
    acceleration = np.diff(velocity, append=plant.velocity) / PERIOD
    return Run(motion, position, velocity, acceleration, command, encoder, filtered_velocity, warmth)


def sense(run: Run, hidden: Hidden, seed: int, *, velocity: bool = True) -> Recording:
    """What is kept of a run.

    Args:
        run: Of the joint.
        hidden: How its torque is recorded.
        seed: Of the noise.
        velocity: Keep the filtered velocity; else there is no such column.
    """
    late = np.concatenate([np.full(hidden.torque_delay, run.command[0]), run.command])[: run.command.size]
    noise = NOISE * np.random.default_rng([seed, 2]).standard_normal(late.size)
    return Recording(
        time=run.motion.time,
        position=run.encoder,
        velocity=run.filtered if velocity else None,
        torque=late + noise,
        position_reference=run.motion.position,
        velocity_reference=run.motion.velocity,
        temperature=run.temperature,
        metadata=RecordingMetadata(torque_kind="commanded"),
    )
