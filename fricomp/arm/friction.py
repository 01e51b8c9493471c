"""What may act in one joint of an arm, as columns of its equations: linear in all parameters.

    F_c s + b + F_v v + D |v|                        every joint
    (E + D_e s) s exp(-(v/v_s)²)                     Stribeck effect
    P (z - s),  z' = v (1 - z s) / d                 presliding: what is missing until a bristle has turned [dahl1968]
    c |τ_l| s,  c_q τ_l² s                           friction that follows the load
    (A cos q + B sin q) s,  k (q - q_0)              friction over position, a spring
    C v |v|,  W (|v|/v_top)ⁿ s                       drag, and viscous friction that falls behind the speed

with s = sign v, and τ_l the torque that the joint transmits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray

from .rows import ArmRows

__all__ = [
    "PLAIN",
    "TERMS",
    "JointForm",
    "JointTerm",
    "column_names",
    "friction_columns",
    "load_columns",
    "turn_bristle",
]

PLAIN = ("coulomb", "offset", "viscous", "viscous_difference")
"""Parameters that every joint has."""

_STRIBECK = (0.02, 0.04, 0.08, 0.15, 0.3)
"""Stribeck velocities to choose from, as parts of a joint's top speed: curves between two of them differ by less than
the noise of a recording in which all joints move."""

_BREAKAWAY = (0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 16e-3)
"""Breakaway distances to choose from [rad] or [m]."""

_EXPONENTS = (0.5, 0.7)
"""Of viscous friction to choose from; the catalogue has 0.5 to 0.9."""


@dataclass(frozen=True)
class JointTerm:
    """Something that may act in a joint.

    Attributes:
        name: In the catalogue of effects; "stribeck" for what every friction law has.
        columns: Its parameters.
        values: Of the variants to choose from; one that has none is None.
        follows_load: Whether its columns need the transmitted torque.
    """

    name: str
    columns: tuple[str, ...]
    values: tuple[float | None, ...] = (None,)
    follows_load: bool = False

    def names(self, variant: int) -> tuple[str, ...]:
        """Names of its columns in one variant."""
        return tuple(f"{self.name}.{column}.{variant}" for column in self.columns)


TERMS = {
    term.name: term
    for term in (
        JointTerm("stribeck", ("excess", "excess_difference"), _STRIBECK),
        JointTerm("presliding_hysteresis", ("level",), _BREAKAWAY),
        JointTerm("position_coulomb", ("cosine", "sine")),
        JointTerm("quadratic_drag", ("coefficient",)),
        JointTerm("power_law_viscous", ("torque_at_top_speed",), _EXPONENTS),
        JointTerm("spring_torque", ("stiffness",)),
        JointTerm("load_coulomb", ("coefficient",), follows_load=True),
        JointTerm("load_quadratic", ("coefficient",), follows_load=True),
    )
}
"""What is tried in every joint."""


@dataclass(frozen=True)
class JointForm:
    """What acts in a joint beside `PLAIN`.

    Attributes:
        terms: Names of `TERMS`, each with the number of its variant.
    """

    terms: tuple[tuple[str, int], ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        """Parameters."""
        return (*PLAIN, *(name for term, variant in self.terms for name in TERMS[term].names(variant)))

    def with_term(self, name: str, variant: int) -> JointForm:
        """This form with one term more."""
        return JointForm((*self.terms, (name, variant)))

    def without_term(self, name: str) -> JointForm:
        """This form with one term less."""
        return JointForm(tuple(term for term in self.terms if term[0] != name))


def column_names() -> tuple[str, ...]:
    """All columns of a joint, in order; those that follow the load come last."""
    terms = sorted(TERMS.values(), key=lambda term: term.follows_load)
    return (*PLAIN, *(name for term in terms for k in range(len(term.values)) for name in term.names(k)))


def friction_columns(rows: ArmRows, joint: int, top_speed: float) -> FloatArray:
    """Columns of one joint, but for those that follow the load.

    Args:
        rows: The equations.
        joint: Number of the joint.
        top_speed: Of the joint [rad/s] or [m/s].

    Returns:
        Shape (n, len(column_names()) - 2).
    """
    middle = float(np.mean(np.concatenate([q[:, joint] for q, _, _ in rows.motion])))

    def build(position: FloatArray, velocity: FloatArray, _: FloatArray) -> FloatArray:
        q, v = position[:, joint], velocity[:, joint]
        s, columns = np.sign(v), []
        for part in _STRIBECK:
            fall = np.exp(-((v / (part * top_speed)) ** 2))
            columns += [s * fall, fall]
        columns += [turn_bristle(q, distance) - s for distance in _BREAKAWAY]
        columns += [np.cos(q) * s, np.sin(q) * s, v * np.abs(v)]
        columns += [s * (np.abs(v) / top_speed) ** n for n in _EXPONENTS]
        columns += [q - middle]
        return np.stack([s, np.ones_like(v), v, np.abs(v), *columns], axis=1)

    return rows.compare(build)


def load_columns(load: FloatArray, sign: FloatArray) -> FloatArray:
    """Columns that follow the transmitted torque [N·m] or [N], in the order of `column_names`. Shape (n, 2)."""
    return np.column_stack([np.abs(load) * sign, load**2 * sign])


def turn_bristle(position: FloatArray, distance: float) -> FloatArray:
    """Part of its level that a bristle holds along a path, from -1 to 1, by Dahl's law [dahl1968]. Shape (n,)."""
    steps = np.diff(position, prepend=position[0])
    z, result = 0.0, np.empty_like(position)
    for k, (step, decay) in enumerate(
        zip(np.sign(steps).tolist(), np.exp(-np.abs(steps) / distance).tolist(), strict=True)
    ):
        z = step + (z - step) * decay if step else z
        result[k] = z
    return result
