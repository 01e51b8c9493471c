"""Many simulations of an arm side by side, with friction that MuJoCo does not know, step by step."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray, FrictionLaw, OperatingPoint
from fricomp.laws.tracing import find_inputs

from .equation import advance_states, resist
from .stacked_law import group_laws

_LEAST_DRY = 1e-9
"""[N·m] or [N] of dry friction that every joint has: MuJoCo makes its constraint of such alone."""


class ArmRun:
    """Simulations of one arm from several states.

    Args:
        model: MuJoCo's `MjModel`, with the joints of `laws` alone; its friction is overwritten.
        order: Degree of freedom of each joint.
        laws: Friction of each joint; None for none.
        data: MuJoCo's `MjData` of each simulation, at its start.
        top: Fastest velocity of each joint [rad/s] or [m/s]. Shape (n_joints,).
    """

    def __init__(
        self,
        model: Any,
        order: Sequence[int],
        laws: Sequence[FrictionLaw | None],
        data: Sequence[Any],
        top: FloatArray,
    ) -> None:
        self._model, self._data, self._top = model, data, top
        self._order, self._back = np.array(order), np.argsort(order)
        self._groups = group_laws(laws)
        self._memory: list[tuple[FloatArray, ...]] = [() for _ in self._groups]
        self._loaded = any(one and "load_torque" in find_inputs(one.terms) for one in laws)
        self._views = [[one.qpos, one.qvel, one.qacc] for one in data]
        self._applied = [one.qfrc_applied for one in data]
        self._dry, self._drag = model.dof_frictionloss, model.dof_damping.reshape(model.nv, -1)[:, 0]

    def remember(self, states: Sequence[tuple[FloatArray, ...]], starts: NDArray[np.intp]) -> None:
        """Take the states of all terms from a motion.

        Args:
            states: Of each joint, those of its terms, each of shape (n_states, n).
            starts: Sample at which each simulation starts.
        """
        self._memory = []
        for group in self._groups:
            each = zip(*([one[:, starts] for one in states[j]] for j in group.joints), strict=True)
            self._memory.append(tuple(np.stack(one, axis=-1) for one in each))

    @property
    def position(self) -> FloatArray:
        """[rad] or [m]. Shape (n_simulations, n_joints)."""
        return np.array([one[0] for one in self._views])[:, self._order]

    def advance(self, push: FloatArray) -> None:
        """One step of the model under these torques [N·m] or [N]. Shape (n_simulations, n_joints)."""
        import mujoco

        h = float(self._model.opt.timestep)
        q, v, a = np.moveaxis(np.array(self._views)[:, :, self._order], 1, 0)
        load = self._find_load() if self._loaded else np.zeros_like(q)
        dry, drag, points = np.zeros_like(push), np.zeros_like(push), []
        for group, memory in zip(self._groups, self._memory, strict=True):
            at = list(group.joints)
            points.append(OperatingPoint(v[:, at], q[:, at], a[:, at], load[:, at]))
            found = resist(group.law, points[-1], memory, h, self._top[at])
            dry[:, at], drag[:, at] = found.dry, found.drag + found.slope
            push[:, at] -= found.held + found.bristle - found.slope * v[:, at]
        dry, drag, push = (one[:, self._back] for one in (np.maximum(dry, _LEAST_DRY), drag, push))
        for row, one in enumerate(self._data):
            self._dry[:], self._drag[:], self._applied[row][:] = dry[row], drag[row], push[row]
            mujoco.mj_step(self._model, one)
        after = np.array([one[1] for one in self._views])[:, self._order]
        self._memory = [
            advance_states(group.law, replace(point, velocity=after[:, list(group.joints)]), memory, h)
            for group, point, memory in zip(self._groups, points, self._memory, strict=True)
        ]

    def _find_load(self) -> FloatArray:
        """What the gears transmit, at the end of the last step: all but what accelerates the rotors. Shape (n, nv)."""
        import mujoco

        moved, rotors = np.empty(self._model.nv), np.asarray(self._model.dof_armature)
        result = np.empty((len(self._data), self._model.nv))
        for row, one in zip(result, self._data, strict=True):
            mujoco.mj_mulM(self._model, one, moved, one.qacc)
            row[:] = moved + one.qfrc_bias - rotors * one.qacc
        return result[:, self._order]
