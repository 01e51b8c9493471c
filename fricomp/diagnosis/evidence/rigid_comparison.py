"""Inertia and gravity of the given simulation beside the refitted ones, by the names of the catalogue."""

from __future__ import annotations

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
from .settings import PARAMETERS

_SAME_FACTOR = ("payload_error", "torque_gain_error")


def compare_rigid(
    plant: Plant, covariance: FloatArray, given: RigidJoint, unit: str, tolerances: Tolerances, acceleration: float
) -> Comparison:
    """Compare inertia and gravity with the simulation's.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia and the two gravity coefficients. Shape (3, 3).
        given: The simulation.
        unit: Unit of torque.
        tolerances: How far the refitted parameters stray beyond what the fit knows of its own error.
        acceleration: RMS of the motion's [rad/s²].
    """
    refit = np.array([plant.inertia / given.inertia, *plant.gravity])
    prior = np.array([1.0, *given.gravity])
    strays = compute_body_strays(plant, float(np.hypot(*given.gravity)), tolerances, acceleration)
    floor = np.asarray(np.diag(strays**2), dtype=np.float64)
    # Relative and not logarithmic: a gain moves inertia and gravity by one factor, and 5 % of that are 0.0488 there.
    relative = np.array([plant.inertia / given.inertia, 1.0, 1.0])
    covariance = covariance * np.outer(relative, relative)
    weight = np.asarray(np.linalg.inv(covariance + floor), dtype=np.float64)
    shift = refit - prior
    hypotheses = {
        "inertia_error": np.array([[1.0, 0.0, 0.0]]).T,
        "payload_error": np.eye(3),
        "torque_gain_error": np.array([[1.0, *given.gravity]]).T,
    }
    scores, _ = weigh_hypotheses(shift, weight, hypotheses)
    if scores[""] - min(scores.values()) < PARAMETERS.significant:
        return Comparison()
    # What moved strays by a part of its own size as well: that tells no hypothesis from another.
    own = np.array([abs(shift[0]), *[float(np.hypot(*shift[1:]))] * 2])
    floor += np.diag((PARAMETERS.form * own) ** 2)
    weight = np.asarray(np.linalg.inv(covariance + floor), dtype=np.float64)
    scores, fitted = weigh_hypotheses(shift, weight, hypotheses)
    best = min(hypotheses, key=lambda name: scores[name])
    # Inertia and gravity that are off by the same factor are a gain as well as another mass. The gain is named where
    # the inertia is seen to follow gravity, one factor leaves nothing of the three shifts and torque signals are off by
    # as much: otherwise nothing speaks for it.
    alike = best in _SAME_FACTOR and scores["torque_gain_error"] <= scores["payload_error"] + PARAMETERS.simpler
    if alike:
        follows = shift[0] ** 2 > PARAMETERS.follows * (covariance[0, 0] + floor[0, 0])
        fits = scores["torque_gain_error"] - PARAMETERS.simpler < PARAMETERS.gain_leaves
        usual = abs(float(fitted["torque_gain_error"][0])) <= PARAMETERS.usual_gain
        best = "torque_gain_error" if follows and fits and usual else "payload_error"
    deviation = np.sqrt(np.diag(covariance + floor))
    changes = [
        describe_change("inertia", given.inertia, plant.inertia, given.inertia * float(deviation[0]), "kg·m²"),
        describe_change("gravity_cos", given.gravity[0], plant.gravity[0], float(deviation[1]), unit),
        describe_change("gravity_sin", given.gravity[1], plant.gravity[1], float(deviation[2]), unit),
    ]
    others = tuple(name for name in _SAME_FACTOR if alike and name != best)
    shift_of_best = _describe_shift(
        best, fitted[best], hypotheses[best], covariance + floor, (given, plant, unit, others)
    )
    return Comparison((shift_of_best,), tuple(changes))


def _describe_shift(
    name: str,
    step: FloatArray,
    span: FloatArray,
    covariance: FloatArray,
    context: tuple[RigidJoint, Plant, str, tuple[str, ...]],
) -> Shift:
    given, plant, unit, alike = context
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(span.T @ np.linalg.inv(covariance) @ span)))
    if name == "inertia_error":
        change, wide = given.inertia * float(step[0]), given.inertia * float(half[0])
        numbers = {"inertia_change": Quantity(change, "kg·m²", (change - wide, change + wide))}
        sentence = f"the inertia is {plant.inertia:.4g} kg·m², not {given.inertia:.4g}"
        return Shift(name, numbers, sentence, alike=alike)
    if name == "torque_gain_error":
        gain, wide = float(step[0]), float(half[0])
        numbers = {"gain_error": Quantity(gain, "1", (gain - wide, gain + wide))}
        return Shift(name, numbers, f"the recorded torque is scaled by {1.0 + gain:.3f}", "measurement", alike)
    inertia, wide = plant.inertia - given.inertia, given.inertia * float(half[0])
    numbers = {
        "gravity_cos_change": Quantity(float(step[1]), unit, (float(step[1] - half[1]), float(step[1] + half[1]))),
        "gravity_sin_change": Quantity(float(step[2]), unit, (float(step[2] - half[2]), float(step[2] + half[2]))),
        "inertia_change": Quantity(inertia, "kg·m²", (inertia - wide, inertia + wide)),
    }
    return Shift(name, numbers, "the load is not the simulation's", alike=alike)
