"""The rigid-body torque of a joint, to be taken off what was measured: MuJoCo's inverse dynamics of an MJCF model."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.simulation_file import compile_simulation

__all__ = ["RigidBody", "derivatives"]

# Stretch of positions that a cubic is fitted to for its derivatives [s].
STRETCH = 0.04


class RigidBody:
    """Gravity, inertia and coupling of an MJCF model, without its friction, damping, limits and contacts.

    Args:
        mjcf: The model file.
        joints: Names of the joints in the adapter's order; others of the model stay at their initial position.

    Raises:
        MissingExtraError: mujoco is not installed.
        ParameterError: The file is no model, or lacks a joint.
    """

    def __init__(self, mjcf: Path | str, joints: Sequence[str]) -> None:
        self._model = compile_simulation(mjcf, "sim")
        import mujoco

        self._mujoco: Any = mujoco
        self._data: Any = mujoco.MjData(self._model)
        self._leave_out_friction()
        addresses = [self._address(name) for name in joints]
        self._positions = [position for position, _ in addresses]
        self._dofs = [dof for _, dof in addresses]

    def _leave_out_friction(self) -> None:
        model, bits = self._model, self._mujoco.mjtDisableBit
        model.opt.disableflags |= bits.mjDSBL_CONSTRAINT | bits.mjDSBL_ACTUATION
        model.dof_damping[:] = 0.0
        model.dof_dampingpoly[:] = 0.0
        model.dof_frictionloss[:] = 0.0

    def _address(self, name: str) -> tuple[int, int]:
        names = [self._model.joint(i).name for i in range(self._model.njnt)]
        if name not in names:
            raise ParameterError(f"the model has no joint {name!r}; it has {', '.join(names)}")
        joint = names.index(name)
        return int(self._model.jnt_qposadr[joint]), int(self._model.jnt_dofadr[joint])

    def has_gravity_on(self, joint: int) -> bool:
        """Whether gravity acts on this joint somewhere; looked for at some random positions."""
        generator = np.random.default_rng(0)
        still = np.zeros((16, len(self._dofs)))
        places = generator.uniform(-np.pi, np.pi, still.shape)
        return bool(np.max(np.abs(self.torque(joint, places, still, still))) > 1e-9)

    def inertias(self, position: Sequence[float]) -> list[float]:
        """Inertia about each joint at a position, the others held [kg·m²] or [kg]."""
        n = len(self._dofs)
        here, still = np.tile(np.asarray(position, dtype=np.float64), (1, 1)), np.zeros((1, n))
        found = []
        for joint in range(n):
            unit = still.copy()
            unit[0, joint] = 1.0
            found.append(float((self.torque(joint, here, still, unit) - self.torque(joint, here, still, still))[0]))
        return found

    def torque(self, joint: int, position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> FloatArray:
        """Torque that a frictionless joint would need for a motion [N·m] or [N]. Shape (n_samples,).

        Args:
            joint: Index in the adapter's order.
            position: Of all joints [rad] or [m]. Shape (n_samples, n_joints).
            velocity: Likewise [rad/s] or [m/s].
            acceleration: Likewise [rad/s²] or [m/s²].
        """
        model, data, inverse = self._model, self._data, self._mujoco.mj_inverse
        found = np.empty(len(position))
        for row in range(len(position)):
            data.qpos[self._positions] = position[row]
            data.qvel[self._dofs] = velocity[row]
            data.qacc[self._dofs] = acceleration[row]
            inverse(model, data)
            found[row] = data.qfrc_inverse[self._dofs[joint]]
        return found


def derivatives(position: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Velocity and acceleration from encoder positions: the derivatives of cubics fitted piece by piece, without lag.

    Args:
        position: [rad] or [m]. Shape (n_samples, n_joints).
        period: Between samples [s].
    """
    from scipy.signal import savgol_filter

    window = max(5, 2 * round(0.5 * STRETCH / period) + 1)
    if len(position) < window:
        return np.zeros_like(position), np.zeros_like(position)
    velocity = savgol_filter(position, window, 3, deriv=1, delta=period, axis=0)
    acceleration = savgol_filter(position, window, 3, deriv=2, delta=period, axis=0)
    return np.asarray(velocity), np.asarray(acceleration)
