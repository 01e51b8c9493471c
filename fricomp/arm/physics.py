"""What friction cannot do: feed energy in, or hold more in a bristle than it has when it slides."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from .coordinates import ArmModel
from .fit import ArmFit
from .friction import TERMS

_SURE = 2.0
"""Standard deviations by which a parameter must be on the wrong side."""

_POSITIVE: tuple[Mapping[str, float], ...] = (
    {"coulomb": 1.0},
    {"viscous": 1.0},
    {"stribeck.excess": 1.0},
    {"load_coulomb.coefficient": 1.0},
    {"load_quadratic.coefficient": 1.0},
    {"presliding_hysteresis.level": 1.0},
    {"creep.level": 1.0},
    {"coulomb": 1.0, "presliding_hysteresis.level": -1.0, "creep.level": -1.0},
    {"quadratic_drag.coefficient": 1.0},
    {"spring_torque.stiffness": 1.0},
    {"power_law_viscous.torque_at_top_speed": 1.0},
    {"backlash.share": 1.0},
    {"joint_elasticity.share": 1.0},
)
"""Weighted sums of a joint's parameters that are not below zero."""

_LATE: Mapping[str, float] = {"torque_delay.delay": 1.0}
"""Of a torque that is later than those of the other joints. One that is earlier has to show it, since links on an
elastic gear look like it."""

_LEAST_SHARE = 0.5
"""Factor on a law that has none, from which it is nearer to the law than to nothing."""

_NONE = 1e-6
"""[kg·m²] or [kg] below zero that a rotor without inertia may come out with, and as much of viscous friction."""


def hold_at_zero(fit: ArmFit) -> ArmModel:
    """The model without a rotor's inertia, or viscous friction, where that came out below zero.

    Friction that falls below zero in one direction first loses what both directions differ by: a joint seldom has it,
    and a file holds none.
    """
    rotorless = fit.model.rotorless | set(np.flatnonzero(fit.armature < -_NONE).tolist())
    pinned = set(fit.model.pinned)
    for j in range(len(fit.arm.joints)):
        values = fit.friction(j)
        least = values["viscous"] - abs(values["viscous_difference"])
        if least < -_NONE:
            free = (j, "viscous_difference") not in pinned
            pinned.add((j, "viscous_difference" if free else "viscous"))
    return replace(fit.model, rotorless=rotorless, pinned=frozenset(pinned))


def is_physical(fit: ArmFit, before: ArmFit | None = None, is_early: Callable[[int], bool] = lambda _: False) -> bool:
    """Whether the friction of every joint can exist.

    Args:
        fit: With its deviations.
        before: Of a model with less: what could not exist there already speaks against no term.
        is_early: Whether the torque of a joint shows that it was recorded before those of the others.
    """
    pairs = [(j, weights) for j in range(len(fit.arm.joints)) for weights in (*_POSITIVE, _LATE)]
    return all(
        _is_positive(fit, j, weights)
        or (before is not None and not _is_positive(before, j, weights))
        or (weights is _LATE and is_early(j))
        for j, weights in pairs
    )


def is_whole(fit: ArmFit, joint: int, term: str) -> bool:
    """Whether a term whose law has no factor comes with one that is nearer to one than to none."""
    return not TERMS[term].whole or fit.friction(joint)[TERMS[term].names(0)[0]] > _LEAST_SHARE


def find_reversed_term(fit: ArmFit) -> tuple[int, str] | None:
    """Number of a joint and the name of a term in it whose own parameter came out below zero; None for no such.

    A term that was more than none when it was taken in is turned round where another one has taken its place. What
    mends the form of another one may be below zero.
    """
    alone = {name.partition(".")[0]: name for weights in _POSITIVE for name in weights if "." in name}
    for j, form in enumerate(fit.model.forms):
        values = fit.friction(j)
        for term, variant in form.terms:
            if term in alone and form.find_head(term) == term and values[f"{alone[term]}.{variant}"] < 0.0:
                return j, term
    return None


def _is_positive(fit: ArmFit, joint: int, weights: Mapping[str, float]) -> bool:
    """Whether a weighted sum of a joint's parameters is not surely below zero; those that it lacks are none."""
    place, names = fit.find_friction(joint)
    values, covariance = fit.x[place], fit.covariance[place, place]
    short = {name.rsplit(".", 1)[0] if "." in name else name: k for k, name in enumerate(names)}
    direction = np.zeros(len(names))
    for name, weight in weights.items():
        at = short.get(name)
        if at is not None:
            direction[at] = weight
    value, spread = float(direction @ values), float(np.sqrt(direction @ covariance @ direction))
    return value >= -_SURE * spread
