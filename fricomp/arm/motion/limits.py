"""What a motion of an arm may do: positions, speeds, torques, and no contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import ParameterError, SimulationFileError
from fricomp.laws import FloatArray
from fricomp.simulation_file import compile_simulation

_POSITION, SPEED_SHARE, _TORQUE = 0.9, 0.5, 0.6
"""Parts of the limits that a motion uses. The rest is for what the controller overshoots, for friction, which nobody
knows yet, and for a simulation that is wrong."""

_FREE = np.pi
"""[rad] or [m] to either side of zero of a joint without a range."""


@dataclass(frozen=True)
class MotionLimits:
    """Limits of all joints.

    Attributes:
        lowest: Position [rad] or [m]. Shape (n_joints,), like the others.
        highest: Position [rad] or [m].
        speed: [rad/s] or [m/s].
        torque: [N·m] or [N].

    Raises:
        ParameterError: A range is empty, or a speed or torque is not positive.
    """

    lowest: FloatArray
    highest: FloatArray
    speed: FloatArray
    torque: FloatArray

    def __post_init__(self) -> None:
        if not (np.all(self.lowest < self.highest) and np.all(self.speed > 0.0) and np.all(self.torque > 0.0)):
            raise ParameterError("each joint of an excitation needs a range of positions, a speed and a torque above 0")

    @classmethod
    def from_ranges(
        cls, ranges: Sequence[tuple[float, float] | None], speed: Sequence[float], torque: Sequence[float]
    ) -> MotionLimits:
        """From the ranges of the joints; None where one turns freely."""
        filled = np.array([(-_FREE, _FREE) if one is None else one for one in ranges], dtype=np.float64)
        return cls(filled[:, 0], filled[:, 1], np.array(speed, dtype=np.float64), np.array(torque, dtype=np.float64))

    @property
    def swing(self) -> FloatArray:
        """Half of the range that is used [rad] or [m]."""
        return np.asarray(0.5 * _POSITION * (self.highest - self.lowest))

    def hold(self, position: FloatArray, velocity: FloatArray, torque: FloatArray) -> bool:
        """Whether a motion stays within the parts of the limits that it may use. Shapes (n, n_joints)."""
        middle = 0.5 * (self.lowest + self.highest)
        return bool(
            np.all(np.abs(position - middle) <= self.swing * (1.0 + 1e-9))
            and np.all(np.abs(velocity) <= SPEED_SHARE * self.speed * (1.0 + 1e-9))
            and np.all(np.abs(torque) <= _TORQUE * self.torque * (1.0 + 1e-9))
        )


class ContactCheck:
    """Whether an arm touches anything of its simulation along a path, as it does not where it stands.

    Shapes from meshes count where the file can be read with them.

    Attributes:
        notes: What is not looked at, in sentences.

    Args:
        simulation: MJCF or URDF.
        joints: Names of the joints in it.
    """

    def __init__(self, simulation: str | Path, joints: Sequence[str]) -> None:
        import mujoco

        self.notes: tuple[str, ...] = ()
        try:
            model: Any = mujoco.MjModel.from_xml_path(str(simulation))
        except ValueError:
            model = compile_simulation(simulation)
            self.notes = ("Meshes of the simulation could not be read: contacts with them are not looked for.",)
        if not any(int(one) for one in model.geom_contype):
            self.notes = ("The simulation has no shapes: contacts are not looked for. Watch the arm.",)
        missing = [name for name in joints if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) < 0]
        if missing:
            raise SimulationFileError(f"{simulation} has no joint {missing[0]!r}")
        self._model, self._data = model, mujoco.MjData(model)
        self._places = [int(model.joint(name).qposadr[0]) for name in joints]
        self._allowed = self._touch(np.array([self._data.qpos[place] for place in self._places]))

    def find(self, position: FloatArray) -> str:
        """The first contact along a path, as `body a with body b`; empty where there is none. Shape (n, n_joints)."""
        for row in position:
            pairs = self._touch(row) - self._allowed
            if pairs:
                a, b = (self._model.body(one).name or f"body {one}" for one in sorted(next(iter(pairs))))
                return f"{a} with {b}"
        return ""

    def _touch(self, position: FloatArray) -> set[frozenset[int]]:
        import mujoco

        data, model = self._data, self._model
        data.qpos[self._places] = position
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        bodies = model.geom_bodyid
        return {
            frozenset(int(bodies[geom]) for geom in data.contact.geom[k])
            for k in range(data.ncon)
            if data.contact.dist[k] < 0.0
        }
