"""Inertia and gravity of the given simulation beside the refitted ones, by the names of the catalogue."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from ..joint.observer import Plant
from ..record.result import Quantity
from .comparison import (
    Comparison,
    Shift,
    Tolerances,
    compute_body_strays,
    describe_change,
    weigh_hypotheses,
)
from .settings import GATES, PARAMETERS

_SAME_FACTOR = ("payload_error", "torque_gain_error")


def compare_rigid(
    plant: Plant,
    covariance: FloatArray,
    given: RigidJoint,
    unit: str,
    tolerances: Tolerances,
    acceleration: float,
    least: float = PARAMETERS.significant,
    material: float = GATES.material,
) -> Comparison:
    """Compare inertia and gravity with the simulation's.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia, the two gravity coefficients and the offset. Shape (4, 4).
        given: The simulation.
        unit: Unit of torque.
        tolerances: How far the refitted parameters stray beyond what the fit knows of its own error.
        acceleration: RMS of the motion's [rad/s²].
        least: Fall of chi squared that what moved must bring.
        material: Torque that what moved must make, in the Coulomb torque.
    """
    static = _list_static(plant, given)
    refit = np.array([plant.inertia / given.inertia, *(one.refitted for one in static)])
    prior = np.array([1.0, *(one.given for one in static)])
    size = float(np.hypot(*given.gravity)) if given.rotary else abs(given.offset)
    strays = compute_body_strays(plant, size, tolerances, acceleration)[: 1 + len(static)]
    floor = np.asarray(np.diag(strays**2), dtype=np.float64)
    # Relative and not logarithmic: a gain moves inertia and gravity by one factor, and 5 % of that are 0.0488 there.
    relative = np.array([plant.inertia / given.inertia, *np.ones(len(static))])
    at = [0, *(one.at for one in static)]
    covariance = covariance[np.ix_(at, at)] * np.outer(relative, relative)
    weight = np.asarray(np.linalg.inv(covariance + floor), dtype=np.float64)
    shift = refit - prior
    hypotheses = {"inertia_error": np.eye(shift.size)[:, :1]}
    if static:
        hypotheses["payload_error"] = np.eye(shift.size)
    if _shows_gravity(prior, covariance + floor):
        hypotheses["torque_gain_error"] = prior[:, None]
    scores, _ = weigh_hypotheses(shift, weight, hypotheses)
    if scores[""] - min(scores.values()) < least or not _matters(shift, material * plant.level, given, acceleration):
        return Comparison()
    # What moved strays by a part of its own size as well: that tells no hypothesis from another.
    own = np.array([abs(shift[0]), *[float(np.linalg.norm(shift[1:]))] * len(static)])
    floor += np.diag((PARAMETERS.form * own) ** 2)
    # Nor does what nobody would miss: a gravity that is off by a trifle makes no other load of another inertia.
    per = np.array([max(given.inertia * acceleration, 1e-12), *np.ones(len(static))])
    trifle = 0.5 * material * plant.level / per
    weight = np.asarray(np.linalg.inv(covariance + floor + np.diag(trifle**2)), dtype=np.float64)
    scores, fitted = weigh_hypotheses(shift, weight, hypotheses)
    best = min(hypotheses, key=lambda name: scores[name])
    # Inertia and gravity that are off by the same factor are a gain as well as another mass. The gain is named where
    # both are seen to be off, one factor leaves nothing of the shifts and torque signals are off by as much: otherwise
    # nothing speaks for it.
    gain = scores.get("torque_gain_error", np.inf)
    alike = best in _SAME_FACTOR and gain <= scores["payload_error"] + PARAMETERS.simpler
    if alike:
        parts = slice(0, 1), slice(1, None)  # the inertia, and what does not depend on acceleration
        follows = min(_measure_surprise(shift, covariance + floor, one) for one in parts) > PARAMETERS.follows
        fits = gain - PARAMETERS.simpler < PARAMETERS.gain_leaves
        usual = abs(float(fitted["torque_gain_error"][0])) <= PARAMETERS.usual_gain
        best = "torque_gain_error" if follows and fits and usual else "payload_error"
    deviation = np.sqrt(np.diag(covariance + floor))
    mass = "kg·m²" if given.rotary else "kg"
    changes = [describe_change("inertia", given.inertia, plant.inertia, given.inertia * float(deviation[0]), mass)]
    changes += [
        describe_change(one.name, one.given, one.refitted, float(own), unit)
        for one, own in zip(static, deviation[1:], strict=True)
    ]
    others = tuple(name for name in _SAME_FACTOR if alike and name != best)
    usual = abs(float(fitted["inertia_error"][0])) <= PARAMETERS.usual_gain
    if best == "inertia_error" and "torque_gain_error" not in hypotheses and usual:
        others = ("torque_gain_error",)
    shift_of_best = _describe_shift(
        best, fitted[best], hypotheses[best], covariance + floor, (given, plant, unit, others), static
    )
    return Comparison((shift_of_best,), tuple(changes))


def _matters(shift: FloatArray, material: float, given: RigidJoint, acceleration: float) -> bool:
    """Whether a shift makes a torque of more than `material` [N·m]."""
    torque = np.hypot(float(shift[0]) * given.inertia * acceleration, float(np.linalg.norm(shift[1:])))
    return bool(torque > material)


def _shows_gravity(prior: FloatArray, covariance: FloatArray) -> bool:
    """Whether the simulation has a gravity that the recording shows: without one, a gain is another inertia."""
    strays = np.diag(covariance)[1:]
    return bool(np.sum(prior[1:] ** 2) > np.sum(strays))


def _measure_surprise(shift: FloatArray, covariance: FloatArray, own: slice) -> float:
    """Chi squared of no shift of some parameters."""
    return float(shift[own] @ np.linalg.solve(covariance[own, own], shift[own]))


class _Static(NamedTuple):
    """A torque of the body that does not depend on its acceleration.

    Attributes:
        name: As an answer calls it.
        at: Its place among the parameters of the base.
        given: As the simulation has it.
        refitted: As the recording has it.
    """

    name: str
    at: int
    given: float
    refitted: float


def _list_static(plant: Plant, given: RigidJoint) -> tuple[_Static, ...]:
    """Gravity of a joint that turns, or the weight that a linear axis lifts; nothing about one that lies level."""
    if given.rotary:
        names = ("gravity_cos", "gravity_sin")
        return tuple(_Static(names[k], 1 + k, given.gravity[k], plant.gravity[k]) for k in range(2))
    return (_Static("weight", 3, given.offset, plant.offset),) if given.offset else ()


def _describe_shift(
    name: str,
    step: FloatArray,
    span: FloatArray,
    covariance: FloatArray,
    context: tuple[RigidJoint, Plant, str, tuple[str, ...]],
    static: tuple[_Static, ...],
) -> Shift:
    given, plant, unit, alike = context
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(span.T @ np.linalg.inv(covariance) @ span)))
    called, mass = ("inertia", "kg·m²") if given.rotary else ("mass", "kg")
    if name == "inertia_error":
        change, wide = given.inertia * float(step[0]), given.inertia * float(half[0])
        numbers = {"inertia_change": Quantity(change, mass, (change - wide, change + wide))}
        sentence = f"the {called} is {plant.inertia:.4g} {mass}, not {given.inertia:.4g}"
        return Shift(name, numbers, sentence, alike=alike)
    if name == "torque_gain_error":
        gain, wide = float(step[0]), float(half[0])
        numbers = {"gain_error": Quantity(gain, "1", (gain - wide, gain + wide))}
        return Shift(name, numbers, f"the recorded torque is scaled by {1.0 + gain:.3f}", "measurement", alike)
    numbers = {
        f"{one.name}_change": Quantity(float(moved), unit, (float(moved - wide), float(moved + wide)))
        for one, moved, wide in zip(static, step[1:], half[1:], strict=True)
    }
    inertia, wide = plant.inertia - given.inertia, given.inertia * float(half[0])
    numbers["inertia_change"] = Quantity(inertia, mass, (inertia - wide, inertia + wide))
    return Shift(name, numbers, "the load is not the simulation's", alike=alike)
