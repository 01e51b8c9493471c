"""A model of MuJoCo along a recorded motion, by inverse dynamics, and on its own, many simulations in one call."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray


def set_step(model: Any, dt: float, longest: float, finest: int = 1) -> int:
    """Divide a sample of `dt` [s] into steps of at most `longest` [s], and at least so many; their number."""
    substeps = max(int(np.ceil(dt / longest - 1e-6)), finest)
    model.opt.timestep = dt / substeps
    return substeps


def invert_motion(
    model: Any, position: FloatArray, velocity: FloatArray, acceleration: FloatArray, substeps: int
) -> tuple[FloatArray, FloatArray]:
    """Torque that the motion takes at each sample, and the activations there. Shapes (n, nv) and (n_activations, n).

    Args:
        model: MuJoCo's `MjModel`.
        position: Of its degrees of freedom [rad] or [m]. Shape (n, nv).
        velocity: [rad/s] or [m/s]. Shape (n, nv).
        acceleration: [rad/s²] or [m/s²]. Shape (n, nv).
        substeps: Steps of a sample.
    """
    import mujoco

    data, n = mujoco.MjData(model), position.shape[0]
    torque, states = np.empty((n, model.nv)), np.empty((model.na, n))
    for k in range(n):
        data.qpos[:], data.qvel[:] = position[k], velocity[k]
        passive: Any = 0.0
        if model.na or model.nu:  # a passive motor has a state and no control, a constant force the reverse
            states[:, k] = data.act
            mujoco.mj_forward(model, data)
            passive = data.qfrc_actuator.copy()
        data.qacc[:] = acceleration[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse - passive
        for _ in range(substeps if model.na else 0):
            data.qpos[:], data.qvel[:] = position[k], velocity[k]
            mujoco.mj_step(model, data)
    return torque, states


def place(data: Any, position: FloatArray, velocity: FloatArray, activation: FloatArray) -> None:
    """Put MuJoCo's `MjData` into a state."""
    data.qpos[:], data.qvel[:], data.act[:] = position, velocity, activation


def roll_out(
    model: Any, starts: tuple[FloatArray, FloatArray, FloatArray], drive: FloatArray, ends: NDArray[np.intp]
) -> FloatArray:
    """Positions after so many steps from each start. Shape (n_ends, n_starts, nq).

    Args:
        model: MuJoCo's `MjModel`.
        starts: Positions, velocities and activations, each of shape (n_starts, ...).
        drive: Torque on each degree of freedom at each step [N·m] or [N]. Shape (n_starts, n_steps, nv).
        ends: Numbers of steps.
    """
    import mujoco
    from mujoco import rollout

    data, kind = mujoco.MjData(model), int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
    initial = np.empty((drive.shape[0], mujoco.mj_stateSize(model, kind)))
    for row, state in zip(initial, zip(*starts, strict=True), strict=True):
        place(data, *state)
        mujoco.mj_getState(model, data, row, kind)
    spec = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    states, _ = rollout.rollout(model, data, initial, drive, control_spec=spec)
    moved: FloatArray = states[:, ends - 1, 1 : 1 + model.nq].transpose(1, 0, 2)  # behind the time
    return moved


def spread_torque(torque: FloatArray, starts: NDArray[np.intp], length: int, substeps: int) -> FloatArray:
    """Mean torque over each step of each simulation. Shape (n_starts, length * substeps)."""
    steps = (np.arange(length * substeps) + 0.5) / substeps
    at = np.minimum(starts[:, None] + steps, torque.size - 1.0)
    return np.interp(at, np.arange(torque.size), torque)
