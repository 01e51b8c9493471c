"""What may act in one joint of an arm, as columns of its equations: linear in all parameters.

    F_c s + b + F_v v + D |v|                        every joint
    (E s + D_e) exp(-|v/v_s|ⁿ)                       Stribeck effect, n from 2 or 1
    W_s n |v/v_s|ⁿ exp(-|v/v_s|ⁿ) s                  along v_s, which moves until W_s = E δv_s/v_s is next to none
    -N_s n ln|v/v_s| |v/v_s|ⁿ exp(-|v/v_s|ⁿ) s       along n, which moves likewise
    C (clip(u / v_c) - s),  u = v + T a              friction that creeps, as MuJoCo's does
    C (tanh(v / w) - s),  w = 0.75 v_c               the same, rounded, as other simulators write it
    -W_c v_c ∂/∂v_c of either                        along v_c, which moves until W_c = C δv_c/v_c is next to none
    P (z - s),  z' = v (1 - z s) / d                 presliding: what is missing until a bristle has turned [dahl1968]
    c |τ_l| s,  c_q τ_l² s                           friction that follows the load
    (A cos nq + B sin nq) s,  k (q - q_0)            friction over position, a spring
    C v |v|,  W (|v|/v_top)ⁿ s                       drag, and viscous friction that falls behind the speed
    A cos nq + B sin nq                              torque that waves with the position, n from what is left
    (G s + H v) (T - T_0)                            friction that follows the temperature, where it is recorded
    e τ_l,  -T_d τ'                                  a torque in another unit than those beside it, or later
    -B (M s" + G s)                                  a gear with a gap, or one that gives way: the load lags the motor
                                                     by s, B is one

with s = sign v, τ_l the torque that the joint transmits, M the mass matrix and G the gradient of gravity.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal

import numpy as np

from fricomp.laws import FloatArray

__all__ = [
    "BRISTLE",
    "CREEP",
    "GEARS",
    "LEAST_CREEP",
    "LEAST_STRIBECK",
    "LOWEST_RIPPLE",
    "MOST_STRIBECK",
    "ORDERS",
    "PLAIN",
    "STRIBECK_EXPONENTS",
    "TERMS",
    "VISCOUS_EXPONENTS",
    "JointForm",
    "JointTerm",
    "column_names",
    "find_columns",
    "is_rounded",
    "list_creep_starts",
    "list_stribeck_starts",
]

PLAIN = ("coulomb", "offset", "viscous", "viscous_difference")
"""Parameters that every joint has."""

CREEP = "creep"
"""Name of the term of friction that never holds: dry friction of simulators, solved softly. It is no physics of a
joint, so that it has no name among the effects."""

BRISTLE = "presliding_hysteresis"
"""Name of the term of a bristle that has to turn before its joint slides."""

_STRIBECK = (0.02, 0.04, 0.08, 0.15, 0.3)
"""Stribeck velocities to start from, as parts of a joint's top speed; the one that is taken moves to where the curve
fits best."""

_STRIBECK_STARTS = (2.0, 1.0)
"""Exponents of the curves to start from, each with all velocities; the one that is taken moves as its velocity does."""

STRIBECK_EXPONENTS = (0.5, 4.0)
"""Between which an exponent lies: joints have 0.5 to 2, and lubricated ones a steeper fall [armstrong1994survey]. A
wrong one turns into viscous friction and drag."""

LEAST_STRIBECK, MOST_STRIBECK = 0.01, 0.6
"""Of a joint's top speed, between which a Stribeck velocity lies: below, no row shows it; above, it is drag."""

_BREAKAWAY = tuple(0.5e-3 * 2.0 ** (0.5 * k) for k in range(12))
"""Breakaway distances to choose from [rad], up to 23 mrad. With steps of two, a bristle between them came as part of
the Coulomb torque at the next one, and the rest of it as what else bends about a reversal."""

_CREEP_SPEEDS = (0.03, 0.06, 0.12, 0.24)
"""Speeds below which friction is viscous and holds nothing to start from, as parts of a joint's top speed; the one that
is taken moves to where it fits best. Below, such rows are not compared; above, it is viscous friction."""

_CREEP_FORMS = (False, True)
"""Whether the corner at that speed is rounded, each with all speeds."""

LEAST_CREEP = 1e-3
"""Of a joint's top speed, below which such friction sticks as far as anyone can see."""

_ARM = 0.1
"""[m/rad] by which distances of an axis that slides are those of a joint that turns: the radius of a pulley. Axes come
back as fast as joints at that distance from their middle do, so that as short a way shows."""

VISCOUS_EXPONENTS = (0.35, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Of viscous friction to choose from; the catalogue has 0.5 to 0.9, and what fits best below is none of it."""

ORDERS = (1.0, 2.0)
"""Waves of friction a turn: of a shaft that is off its axis, and of one that is oval."""

LOWEST_RIPPLE = 4.0
"""Least waves of torque a radian times 2 pi: slower ones are gravity's, which the links have."""

Filled = Literal["motion", "stribeck", "creep", "delay", "ripple", "gap", "spring", "load"]
"""What the columns of a term are made of: the motion, a Stribeck or a creep velocity that is found, the torque's own
rate, a wave of an order that is found, a gap whose width is found, a gear whose stiffness is found, or the transmitted
torque."""

GEARS: tuple[Filled, ...] = ("gap", "spring")
"""Of these, what lets a link move otherwise than its motor, so that the other joints feel it."""


@dataclass(frozen=True)
class JointTerm:
    """Something that may act in a joint.

    Attributes:
        name: In the catalogue of effects; "stribeck" for what every friction law has.
        columns: Its parameters.
        values: Of the variants to choose from; one that has none is None.
        filled: What its columns are made of.
        label: What differs between its variants.
        alike: Names that no recording of an arm tells from it.
        family: Of forms of the same physics: a second one of a family mends the form of the first and is no effect of
            its own; by default a term stands alone.
        replaces: Of `PLAIN`, what it may stand in place of.
        whole: Whether its law has no factor: its one parameter is the share of it that is there, and should be one.
        on_slides: Factor on its variants on an axis that slides; None where it is of a joint that turns alone.
        counted: Whether its variants are whole numbers, so that nothing lies between two of them or beyond.
    """

    name: str
    columns: tuple[str, ...]
    values: tuple[float | None, ...] = (None,)
    filled: Filled = "motion"
    label: str = ""
    alike: tuple[str, ...] = ()
    family: str = ""
    replaces: tuple[str, ...] = ()
    whole: bool = False
    on_slides: float | None = 1.0
    counted: bool = False

    def list_values(self, *, rotary: bool) -> list[float]:
        """What its variants are on a joint that turns, or on an axis that slides; empty where it has one form alone."""
        factor = 1.0 if rotary else self.on_slides
        return [one * factor for one in self.values if one is not None and factor is not None]

    def bound_variant(self, variant: int, *, rotary: bool) -> tuple[float, float]:
        """The values that were tried beside that of a variant, between which it lies; itself where they are counted."""
        steps = self.list_values(rotary=rotary)
        if self.counted:
            return steps[variant], steps[variant]
        return steps[max(variant - 1, 0)], steps[min(variant + 1, len(steps) - 1)]

    def is_at_end(self, variant: int) -> bool:
        """Whether a variant is the first or the last that was tried, so that what it stands for may lie beyond."""
        return not self.counted and variant in (0, len(self.values) - 1)

    def names(self, variant: int) -> tuple[str, ...]:
        """Names of its columns in one variant."""
        return _name_columns(self, variant)


@cache
def _name_columns(term: JointTerm, variant: int) -> tuple[str, ...]:
    return tuple(f"{term.name}.{column}.{variant}" for column in term.columns)


TERMS = {
    term.name: term
    for term in (
        JointTerm(
            "stribeck",
            ("excess", "excess_difference", "width", "shape"),
            _STRIBECK * len(_STRIBECK_STARTS),
            filled="stribeck",
        ),
        JointTerm(BRISTLE, ("level",), _BREAKAWAY, label="breakaway_distance", on_slides=_ARM),
        JointTerm(CREEP, ("level", "width"), _CREEP_SPEEDS * len(_CREEP_FORMS), filled="creep"),
        JointTerm("position_coulomb", ("cosine", "sine"), ORDERS, label="order", on_slides=None, counted=True),
        JointTerm("quadratic_drag", ("coefficient",), family="speed"),
        JointTerm(
            "power_law_viscous",
            ("torque_at_top_speed",),
            VISCOUS_EXPONENTS,
            label="exponent",
            family="speed",
            replaces=("viscous",),
        ),
        JointTerm("spring_torque", ("stiffness",)),
        JointTerm("thermal_friction", ("coulomb_slope", "viscous_slope")),
        JointTerm("torque_delay", ("delay",), filled="delay", alike=("drive_lag",)),
        JointTerm("cogging", ("cosine", "sine"), filled="ripple"),
        JointTerm("backlash", ("share",), filled="gap", family="gear", whole=True, on_slides=None),
        JointTerm("joint_elasticity", ("share",), filled="spring", family="gear", whole=True, on_slides=None),
        JointTerm("load_coulomb", ("coefficient",), filled="load", family="load"),
        JointTerm("load_quadratic", ("coefficient",), filled="load", family="load"),
        JointTerm("torque_gain_error", ("gain_error",), filled="load"),
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

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Parameters."""
        return (*PLAIN, *(name for term, variant in self.terms for name in TERMS[term].names(variant)))

    def with_term(self, name: str, variant: int) -> JointForm:
        """This form with one term more."""
        return JointForm((*self.terms, (name, variant)))

    def with_variant(self, name: str, variant: int) -> JointForm:
        """This form with another variant of a term that it has."""
        return JointForm(tuple((term, variant if term == name else k) for term, k in self.terms))

    def without_term(self, name: str) -> JointForm:
        """This form without a term, and without what mends the form of it."""
        mends = {other for other in self.names if self.find_head(other) == name}
        return JointForm(tuple(term for term in self.terms if term[0] != name and term[0] not in mends))

    def keep_terms(self, terms: Collection[tuple[str, int]]) -> JointForm:
        """What this form has in common with some terms."""
        return JointForm(tuple(one for one in self.terms if one in terms))

    def drop_columns(self, less: JointForm) -> tuple[str, ...]:
        """Parameters that this form has beyond another one."""
        return () if self == less else tuple(name for name in self.columns if name not in less.columns)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the terms, in the order in which they were taken in."""
        return tuple(name for name, _ in self.terms)

    @property
    def geared(self) -> bool:
        """Whether its gear has a gap or gives way."""
        return any(TERMS[name].filled in GEARS for name in self.names)

    def has_other_form(self, name: str) -> bool:
        """Whether another term is a form of the same effect."""
        family = TERMS[name].family
        return bool(family) and any(other != name and TERMS[other].family == family for other in self.names)

    def find_head(self, name: str) -> str:
        """The term whose form this one mends: the first of its family, or itself."""
        family = TERMS[name].family
        return next(other for other in self.names if other == name or (family and TERMS[other].family == family))


_FILLED: tuple[Filled, ...] = ("motion", "stribeck", "creep", "delay", "ripple", "gap", "spring", "load")


@cache
def column_names() -> tuple[str, ...]:
    """All columns of a joint, in order: those of the motion first, those that follow the load last."""
    return (*PLAIN, *(name for filled in _FILLED for name in _list_columns(filled)))


@cache
def find_columns(filled: Filled) -> slice:
    """Where the columns stand that are made of one thing, among all of a joint's friction."""
    sizes = [len(_list_columns(each)) + (len(PLAIN) if each == "motion" else 0) for each in _FILLED]
    at = _FILLED.index(filled)
    return slice(sum(sizes[:at]), sum(sizes[: at + 1]))


def _list_columns(filled: Filled) -> tuple[str, ...]:
    terms = [term for term in TERMS.values() if term.filled == filled]
    return tuple(name for term in terms for k in range(len(term.values)) for name in term.names(k))


def list_stribeck_starts() -> FloatArray:
    """Stribeck velocity, as part of the top speed, and exponent of each variant's start. Shape (n_variants, 2)."""
    return np.array([(speed, exponent) for exponent in _STRIBECK_STARTS for speed in _STRIBECK])


def list_creep_starts() -> FloatArray:
    """Speed below which friction creeps, as part of the top speed, of each variant's start. Shape (n_variants,)."""
    return np.array(TERMS[CREEP].values)


def is_rounded(variant: int) -> bool:
    """Whether a variant of friction that creeps is a hyperbolic tangent of the velocity; else it has a corner, and is
    ahead of that."""
    return _CREEP_FORMS[variant // len(_CREEP_SPEEDS)]
