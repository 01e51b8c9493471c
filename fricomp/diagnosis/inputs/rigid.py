"""The rigid body of the user's simulation: inertia, gravity and friction of one joint of an MJCF or URDF file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.simulation_file import compile_simulation

from .track import FloatArray


@dataclass(frozen=True)
class Spring:
    """A spring of a simulation: its torque is a polynomial of x, the position less the reference.

    Attributes:
        coefficients: Coefficients of x, x² and x³ [N·m/rad, N·m/rad², N·m/rad³]; further ones of higher powers.
        reference: Position at which it is at rest [rad] or [m].
    """

    coefficients: tuple[float, ...]
    reference: float = 0.0

    @property
    def stiffness(self) -> float:
        """At rest [N·m/rad] or [N/m]."""
        return self.coefficients[0]

    def compute_torque(self, position: FloatArray) -> FloatArray:
        """Torque that holds the joint against the spring [N·m] or [N]. Shape (n,)."""
        powers = np.array([*self.coefficients[::-1], 0.0], dtype=np.float64)
        return np.asarray(np.polyval(powers, position - self.reference), dtype=np.float64)


@dataclass(frozen=True)
class RigidJoint:
    """What a simulation says about one joint, the others held at their reference position.

    Attributes:
        inertia: With armature [kg·m²] or [kg].
        gravity: Coefficients of cos q and sin q [N·m]; zero for a linear joint.
        offset: Constant load [N·m] or [N].
        damping: Viscous friction [N·m·s/rad] or [N·s/m].
        friction_loss: Dry friction [N·m] or [N].
        rotary: Whether the joint turns.
        spring: Spring between the joint and its base; None where there is none.
        covariance: Covariance of log inertia, gravity, offset and both friction curves, in the order of the diagnosis'
            base, where all of them were read off a recording; None where they are exact. Shape (12, 12).
        error: Relative standard deviation by which inertia and gravity may be off before any recording is looked at:
            the prior that departures from the simulation cost by.
    """

    inertia: float
    gravity: tuple[float, float]
    offset: float
    damping: float
    friction_loss: float
    rotary: bool
    spring: Spring | None = None
    covariance: FloatArray | None = field(default=None, compare=False)
    error: float = 0.2


def read_simulation(path: str | Path, joint: str | None = None) -> RigidJoint:
    """Read one joint of a simulation.

    Args:
        path: MJCF or URDF file.
        joint: Name of the joint; may be left out where there is one joint only.

    Raises:
        DiagnosisError: The file cannot be read, or the joint is not in it.
    """
    model = compile_simulation(path)
    import mujoco

    names = [model.joint(i).name for i in range(model.njnt)]
    if not names:
        raise DiagnosisError(f"{path} has no joint: give a file whose joint moves")
    if joint is None and len(names) > 1:
        raise DiagnosisError(f"{path} has several joints: say which of {', '.join(names)}")
    if joint is not None and joint not in names:
        raise DiagnosisError(f"{path} has no joint {joint!r}; its joints: {', '.join(names)}")
    return _measure(mujoco, model, names.index(joint) if joint is not None else 0)


def _measure(mujoco: object, model: object, index: int) -> RigidJoint:
    """Inertia and gravity over one turn, by MuJoCo's own recursion."""
    mj, m = mujoco, model
    data = mj.MjData(m)  # type: ignore[attr-defined]
    address, dof = int(m.jnt_qposadr[index]), int(m.jnt_dofadr[index])  # type: ignore[attr-defined]
    rotary = int(m.jnt_type[index]) == int(mj.mjtJoint.mjJNT_HINGE)  # type: ignore[attr-defined]
    angles = np.linspace(0.0, 2 * np.pi, 16, endpoint=False) if rotary else np.zeros(1)
    bias = []
    for angle in angles:
        data.qpos[address] = angle
        mj.mj_forward(m, data)  # type: ignore[attr-defined]
        bias.append(float(data.qfrc_bias[dof]))
    full = np.zeros((m.nv, m.nv))  # type: ignore[attr-defined]
    mj.mj_fullM(m, data, full)  # type: ignore[attr-defined]
    cosine = 2.0 * float(np.mean(bias * np.cos(angles))) if rotary else 0.0
    sine = 2.0 * float(np.mean(bias * np.sin(angles))) if rotary else 0.0
    return RigidJoint(
        inertia=float(full[dof, dof]),
        gravity=(cosine, sine),
        offset=float(np.mean(bias)),
        damping=float(np.ravel(m.dof_damping[dof])[0]),  # type: ignore[attr-defined]
        friction_loss=float(m.dof_frictionloss[dof]),  # type: ignore[attr-defined]
        rotary=rotary,
        spring=_read_spring(m, index),
    )


def _read_spring(model: Any, index: int) -> Spring | None:
    """The spring of one joint; older versions of MuJoCo know straight ones only."""
    further = np.ravel(model.jnt_stiffnesspoly[index]) if hasattr(model, "jnt_stiffnesspoly") else np.zeros(0)
    coefficients = (float(np.ravel(model.jnt_stiffness[index])[0]), *map(float, further))
    reference = float(model.qpos_spring[int(model.jnt_qposadr[index])])
    return Spring(coefficients, reference) if any(coefficients) else None
