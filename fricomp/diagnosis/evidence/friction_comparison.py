"""Friction and constant load of the given simulation beside the refitted ones, by the names of the catalogue."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from scipy.linalg import block_diag

from fricomp.errors import ParameterError
from fricomp.laws import StribeckCurve
from fricomp.model import FrictionModel

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from ..joint.observer import Plant
from ..record.result import FRICTION_CHANGES, Change, Quantity
from .comparison import (
    Comparison,
    Shift,
    Tolerances,
    compute_inertia_stray,
    describe_change,
    weigh_hypotheses,
)
from .settings import PARAMETERS

_FORWARD, _REVERSE = 4, 8
"""Where the curves of the two directions begin among the base's parameters."""
_VISCOUS = 3
"""Which number of a curve is the viscous coefficient; the first is the Coulomb torque."""
_OFFSET, _ASYMMETRY = "torque_offset", "direction_asymmetry"
_LEVELS, _SHAPE = 3, 5
"""Where offset and levels begin in a shift, and the shape of the curves."""


@dataclass(frozen=True)
class GivenFriction:
    """What a refit is compared with.

    Attributes:
        model: The friction model.
        offset: Constant load of the simulation [N·m] or [N].
        rigid: The simulation, where the refit does not move its inertia and gravity by more than their error.
        exact: Whether the model says how large the friction is; the friction of a simulation often only says that
            there is some.
    """

    model: FrictionModel
    offset: float = 0.0
    rigid: RigidJoint | None = None
    exact: bool = True


def would_push(plant: Plant, offset: float) -> bool:
    """Whether friction alone would push the joint in one direction, with a constant load of `offset` [N·m] or [N].

    While it slides a joint shows what each direction needs in all, and no friction is less than nothing. Where the
    friction falls over all of the motion, static friction is what there is of it.
    """
    beside = plant.offset - offset
    forward, reverse = max(plant.forward[:2]), max(plant.reverse[:2])
    return min(forward + beside, reverse - beside) < 0.0


def compare_friction(
    plant: Plant, covariance: FloatArray, given: GivenFriction, unit: str, tolerances: Tolerances, acceleration: float
) -> Comparison:
    """Compare offset and the symmetry of the friction with a given friction model.

    What both directions have in common may differ from the model. Of how they differ the model says all four numbers of
    a curve, and the simulation says inertia and gravity: a refit that leaves all of them free knows the offset ten
    times worse than one that leaves alone what has not changed, since gravity is nearly constant over a short range.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia, gravity, offset and both curves, in the order of the base. Shape (12, 12).
        given: The friction model, beside the simulation.
        unit: Unit of torque.
        tolerances: How far the refitted parameters stray beyond what the fit knows of its own error.
        acceleration: RMS of the motion's, in unit of position/s².
    """
    try:
        forward, reverse = given.model.forward, given.model.reverse
    except ParameterError:
        return Comparison()
    sides = (forward.coulomb_torque, reverse.coulomb_torque) if given.exact else (plant.forward[0], plant.reverse[0])
    level = max(0.5 * sum(sides), 1e-9)
    curves = [_list_numbers(_list_curve(one)) for one in (forward, reverse)]
    odd = _compute_odd_shift(plant, covariance, curves, given)
    strays = _compute_strays(odd, level, tolerances, compute_inertia_stray(plant, tolerances, acceleration))
    shifts = _name_uneven(odd, strays, (level, unit))
    return Comparison(shifts, _list_level_changes(plant, covariance, given, unit, {one.name for one in shifts}))


def _list_level_changes(
    plant: Plant, covariance: FloatArray, given: GivenFriction, unit: str, named: set[str]
) -> tuple[Change, ...]:
    """Coulomb torques of both directions beside the given ones, where they are named to differ, with what was not named
    as it was given: a joint that slides shows only the sum of a level and the offset."""
    levels = given.model.forward.coulomb_torque, given.model.reverse.coulomb_torque
    rows = np.zeros((2, covariance.shape[0]))
    rows[0, _FORWARD], rows[1, _REVERSE] = 1.0, 1.0
    shift = np.zeros(2)
    if named == {_ASYMMETRY}:
        rows[:, _LEVELS] = 1.0, -1.0
        shift = given.offset * np.array([-1.0, 1.0])
    elif named == {_OFFSET}:
        rows[:, [_FORWARD, _REVERSE]] = 0.5
        shift = 0.5 * (levels[0] - levels[1]) * np.array([1.0, -1.0])
    values = rows[:, [_LEVELS, _FORWARD, _REVERSE]] @ [plant.offset, plant.forward[0], plant.reverse[0]] + shift
    deviations = np.sqrt(np.maximum(np.diag(rows @ covariance @ rows.T), 0.0))
    return tuple(
        describe_change(f"{side}.coulomb_torque", level, float(value), float(deviation), unit)
        for side, level, value, deviation in zip(("forward", "reverse"), levels, values, deviations, strict=True)
        if named
    )


def list_friction_changes(
    plant: Plant, covariance: FloatArray, given: RigidJoint, units: tuple[str, str], tolerances: Tolerances
) -> tuple[Change, ...]:
    """Dry and viscous friction of a simulation beside the refitted ones, where they differ for sure.

    The friction of a joint is identified, so that they say nothing about the verdict. A simulation with neither has its
    friction elsewhere.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia, gravity, offset and both curves, in the order of the base. Shape (12, 12).
        given: The simulation.
        units: Of torque and position.
        tolerances: How far the refitted parameters stray beyond what the fit knows of its own error.
    """
    if not (given.damping or given.friction_loss):
        return ()
    changes = []
    for name, at, value, unit in (
        (FRICTION_CHANGES[0], 0, given.friction_loss, units[0]),
        (FRICTION_CHANGES[1], _VISCOUS, given.damping, f"{units[0]}·s/{units[1]}"),
    ):
        refitted, both = 0.5 * (plant.forward[at] + plant.reverse[at]), [_FORWARD + at, _REVERSE + at]
        deviation = 0.5 * float(np.sqrt(max(np.sum(covariance[np.ix_(both, both)]), 0.0)))
        stray = float(np.hypot(deviation, tolerances.uneven * refitted))
        if (refitted - value) ** 2 > PARAMETERS.significant * stray**2:
            changes.append(describe_change(name, value, refitted, deviation, unit))
    return tuple(changes)


@dataclass(frozen=True)
class _Odd:
    """How a refit differs from what was given, but for what both directions have in common.

    Attributes:
        shift: Of log inertia and gravity, of the offset, and of half the difference of the directions in Coulomb
            torque, excess of the static one, log Stribeck velocity and viscous coefficient. Shape (8,).
        covariance: Of the shift. Shape (8, 8).
        curve: Mean of both refitted curves, in those numbers. Shape (4,).
        gravity: Amplitude of the simulation's gravity; None where inertia and gravity are free.
    """

    shift: FloatArray
    covariance: FloatArray
    curve: FloatArray
    gravity: float | None


def _compute_odd_shift(
    plant: Plant, covariance: FloatArray, curves: Sequence[FloatArray], given: GivenFriction
) -> _Odd:
    body, rigid = np.array([log(plant.inertia), *plant.gravity, plant.offset - given.offset]), given.rigid
    if rigid is not None:
        body[:_LEVELS] -= [log(rigid.inertia), *rigid.gravity]
    refitted = [_list_numbers(one) for one in (plant.forward, plant.reverse)]
    moved = [mine - theirs for mine, theirs in zip(refitted, curves, strict=True)]
    halves = np.asarray(block_diag(np.eye(_FORWARD), 0.5 * np.hstack([np.eye(4), -np.eye(4)])), dtype=np.float64)
    return _Odd(
        shift=halves @ np.concatenate([body, *moved]),
        covariance=halves @ covariance @ halves.T,
        curve=0.5 * (refitted[0] + refitted[1]),
        gravity=None if rigid is None else float(np.hypot(*rigid.gravity)),
    )


def _list_curve(one: StribeckCurve) -> tuple[float, float, float, float]:
    return one.coulomb_torque, one.static_torque, one.stribeck_velocity, one.viscous_coefficient


def _list_numbers(curve: tuple[float, float, float, float]) -> FloatArray:
    """Coulomb torque, excess of the static one, log Stribeck velocity and viscous coefficient."""
    coulomb, static, velocity, viscous = curve
    return np.array([coulomb, static - coulomb, log(max(velocity, 1e-12)), viscous])


def _compute_strays(odd: _Odd, level: float, tolerances: Tolerances, inertia: float) -> FloatArray:
    """Covariance by which the shift strays beyond what the fit knows, `inertia` being that of its log. Shape (8, 8)."""
    torque, excess = tolerances.uneven * level, max(float(odd.curve[1]), 1e-9)
    gravity = float(np.hypot(tolerances.gravity * (odd.gravity or 0.0), torque))
    sides = np.array([[0.5, 0.5], [0.5, -0.5]])  # offset and odd part, from their sum and their difference
    split = sides @ np.diag([torque, PARAMETERS.split * level]) ** 2 @ sides.T
    # Of the shape of a curve, by as much torque; of the viscous torque where it is as large as the Coulomb torque.
    shape = np.diag([torque, torque / excess, tolerances.uneven * float(odd.curve[3])]) ** 2
    return np.asarray(block_diag(np.diag([inertia, gravity, gravity]) ** 2, split, shape), dtype=np.float64)


def _name_uneven(odd: _Odd, strays: FloatArray, context: tuple[float, str]) -> tuple[Shift, ...]:
    """Names for a shift of offset and odd part of the Coulomb torque: one of the two where that is enough."""
    covariance = odd.covariance + strays
    spans = np.eye(8)[:, _LEVELS:_SHAPE]
    spans[_SHAPE, 1] = odd.curve[1] / max(float(odd.curve[0]), 1e-9)  # friction that is stronger one way is so at rest
    offset, asymmetry = _OFFSET, _ASYMMETRY
    both = f"{offset}+{asymmetry}"
    hypotheses = {offset: spans[:, :1], asymmetry: spans[:, 1:], both: spans}
    options = []
    for held in _choose_held(odd):
        weight = np.asarray(np.linalg.inv(covariance[np.ix_(held, held)]), dtype=np.float64)
        some = {name: span[held] for name, span in hypotheses.items()}
        scores, fitted = weigh_hypotheses(odd.shift[held], weight, some)
        options.append((min(scores.values()) + PARAMETERS.simpler * (8 - len(held)), scores, fitted, weight, some))
    _, scores, fitted, weight, some = min(options, key=lambda option: option[0])
    best = min(scores, key=lambda name: scores[name])
    if not best or scores[""] - scores[best] < PARAMETERS.significant:
        return ()
    # Static friction need not follow the Coulomb torque: it alone calls in no second name, and where it alone tells the
    # two apart, both stay possible.
    sliding = options[-1][1]
    if best == both and min(sliding[offset], sliding[asymmetry]) < sliding[both]:
        best = min((offset, asymmetry), key=lambda name: scores[name])
        _, _, fitted, weight, some = options[-1]
    alike = best != both and abs(sliding[offset] - sliding[asymmetry]) <= PARAMETERS.simpler
    if alike and scores[offset] <= scores[asymmetry] + PARAMETERS.simpler:
        best = offset  # it leaves the joint as it is
    span = some[best]
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(span.T @ weight @ span)))
    others = tuple(name for name in (offset, asymmetry) if alike and name != best)
    return tuple(
        _describe_uneven(name, float(value), float(wide), context, others)
        for name, value, wide in zip(best.split("+"), fitted[best], half, strict=True)
    )


def _choose_held(odd: _Odd) -> list[list[int]]:
    """Rows of the shift that count, all of them first: what has changed besides is left free, where it must be."""
    body, levels, shape = list(range(_LEVELS)), [_LEVELS, _LEVELS + 1], list(range(_SHAPE, 8))
    free = [[*levels, *shape], levels]
    return free if odd.gravity is None else [[*body, *levels, *shape], [*body, *levels], *free]


def _describe_uneven(
    name: str, value: float, half: float, context: tuple[float, str], alike: tuple[str, ...] = ()
) -> Shift:
    level, unit = context
    if name == _OFFSET:
        numbers = {"offset": Quantity(value, unit, (value - half, value + half))}
        return Shift(name, numbers, f"a constant torque of {value:.3g} {unit} is missing", alike=alike)
    ratio, wide = value / level, half / level
    numbers = {
        "asymmetry": Quantity(ratio, "1", (ratio - wide, ratio + wide)),
        "coulomb_difference": Quantity(2.0 * value, unit, (2.0 * (value - half), 2.0 * (value + half))),
    }
    # A difference beyond the level itself is no share of anything.
    size = f"{200 * abs(ratio):.0f} %" if abs(ratio) <= PARAMETERS.told_in_percent else f"{2 * abs(value):.3g} {unit}"
    return Shift(name, numbers, f"friction differs between the directions by {size}", alike=alike)
