"""Friction of one joint of an arm as columns of its equations, linear in all parameters.

    F_c s + b + F_v v + D |v| + (E + D_e s) s exp(-(v/v_s)²) + c |τ_l| s,  s = sign v

with a few Stribeck velocities v_s to choose from, and τ_l the torque that the joint transmits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray

from .rows import ArmRows

__all__ = ["PLAIN", "STRIBECK", "FrictionForm", "friction_columns", "friction_names"]

PLAIN = ("coulomb", "offset", "viscous", "viscous_difference")
"""Parameters that every joint has."""

STRIBECK = (0.02, 0.04, 0.08, 0.15, 0.3)
"""Stribeck velocities to choose from, as parts of a joint's top speed. Curves between two of them differ by less than
the noise of a recording in which all joints move."""


@dataclass(frozen=True)
class FrictionForm:
    """What of a joint's friction is fitted beside `PLAIN`.

    Attributes:
        stribeck: Number of the Stribeck velocity in `STRIBECK`; None for a joint without a Stribeck effect.
        follows_load: Whether friction grows with the transmitted torque.
    """

    stribeck: int | None = None
    follows_load: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters."""
        falls = () if self.stribeck is None else (f"excess {self.stribeck}", f"excess_difference {self.stribeck}")
        return (*PLAIN, *falls, *(("load",) if self.follows_load else ()))


def friction_names() -> tuple[str, ...]:
    """All columns of a joint, in order; the load comes last."""
    falls = [f"{name} {k}" for k in range(len(STRIBECK)) for name in ("excess", "excess_difference")]
    return (*PLAIN, *falls, "load")


def friction_columns(rows: ArmRows, joint: int, top_speed: float, load: FloatArray) -> FloatArray:
    """All columns of one joint.

    Args:
        rows: The equations.
        joint: Number of the joint.
        top_speed: Of the joint [rad/s] or [m/s].
        load: Torque that the joint transmits, at the rows [N·m] or [N]. Shape (n,).

    Returns:
        Shape (n, len(friction_names())).
    """

    def build(_: FloatArray, velocity: FloatArray, __: FloatArray) -> FloatArray:
        v = velocity[:, joint]
        sign, columns = np.sign(v), []
        for part in STRIBECK:
            fall = np.exp(-((v / (part * top_speed)) ** 2))
            columns += [sign * fall, fall]
        return np.stack([sign, np.ones_like(v), v, np.abs(v), *columns], axis=1)

    columns = rows.compare(build)
    return np.column_stack([columns, np.abs(load) * columns[:, 0]])
