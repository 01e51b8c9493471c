"""Parameters before physics: what a refit moves in the simulation that was given, by the names of the catalogue."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np
from msgspec.structs import replace

from fricomp.errors import ParameterError
from fricomp.model import FrictionModel

from .observer import Plant
from .result import Change, NamedEffect, Quantity
from .rigid import RigidJoint
from .track import FloatArray

__all__ = ["NAMED", "PLAIN", "SPLIT", "UNEXPLAINED", "Comparison", "Doubt", "compare_friction", "compare_rigid"]

_SAME_FACTOR = ("payload_error", "torque_gain_error")
_USUAL_GAIN = 0.1  # largest gain error of a torque signal that is usual; masses are off by more
_FOLLOWS = 9.0  # chi squared of the inertia's own shift, from which it is seen to follow gravity
_SIGNIFICANT = 25.0  # fall of chi squared that a change must bring
_SIMPLER = 4.0  # chi squared that one more parameter must be worth
# A joint that slides shows offset plus half the difference of the directions; only its presliding tells one from the
# other: deviation of that difference over the Coulomb level, of which the fit is far too sure, from simulated joints
# with nothing missing.
SPLIT = 0.22


@dataclass(frozen=True)
class Doubt:
    """Standard deviations by which refitted parameters stray beyond what the fit knows of its own error.

    Attributes:
        inertia: Over the inertia.
        gravity: Over its amplitude.
        sliding: Over the Coulomb level: of gravity too, and of the offset with half the difference of the directions.
    """

    inertia: float
    gravity: float
    sliding: float


# From simulated joints with nothing missing, with one effect that was named, and with something that was not.
PLAIN, NAMED, UNEXPLAINED = Doubt(0.002, 3e-4, 1e-3), Doubt(0.005, 2e-3, 3e-3), Doubt(0.02, 0.01, 0.02)


@dataclass(frozen=True)
class Comparison:
    """Parameters that differ from the given ones."""

    effects: tuple[NamedEffect, ...] = ()
    changes: tuple[Change, ...] = ()


def compare_rigid(plant: Plant, covariance: FloatArray, given: RigidJoint, unit: str, doubt: Doubt) -> Comparison:
    """Compare inertia and gravity with the simulation's.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia and the two gravity coefficients. Shape (3, 3).
        given: The simulation.
        unit: Unit of torque.
        doubt: Of the refitted parameters.
    """
    gravity = float(np.hypot(*given.gravity))
    refit = np.array([log(plant.inertia), *plant.gravity])
    prior = np.array([log(given.inertia), *given.gravity])
    # Gravity far below friction says nothing about a gain: the floor keeps chi squared from tiny biases.
    least = max(float(np.hypot(doubt.gravity * gravity, doubt.sliding * plant.level)), 1e-12)
    floor = np.diag([doubt.inertia, least, least]) ** 2
    weight = np.linalg.inv(covariance + floor)
    shift = refit - prior
    hypotheses = {
        "inertia_error": np.array([[1.0, 0.0, 0.0]]).T,
        "payload_error": np.eye(3),
        "torque_gain_error": np.array([[1.0, *given.gravity]]).T,
    }
    scores, fitted = _weigh(shift, weight, hypotheses)
    best = min(scores, key=lambda name: scores[name])
    if not best or scores[""] - scores[best] < _SIGNIFICANT:
        return Comparison()
    # Inertia and gravity that are off by the same factor are a gain as well as another mass; where the inertia is not
    # seen to follow, nothing speaks for the gain.
    alike = best in _SAME_FACTOR and scores["torque_gain_error"] <= scores["payload_error"] + _SIMPLER
    if alike:
        follows = shift[0] ** 2 > _FOLLOWS * (covariance[0, 0] + floor[0, 0])
        usual = abs(float(fitted["torque_gain_error"][0])) <= _USUAL_GAIN
        best = "torque_gain_error" if follows and usual else "payload_error"
    deviation = np.sqrt(np.diag(covariance))
    changes = [
        _change("inertia", given.inertia, plant.inertia, plant.inertia * float(deviation[0]), "kg·m²"),
        _change("gravity_cos", given.gravity[0], plant.gravity[0], float(deviation[1]), unit),
        _change("gravity_sin", given.gravity[1], plant.gravity[1], float(deviation[2]), unit),
    ]
    named = _named(best, fitted[best], hypotheses[best], np.linalg.inv(weight), (given, plant, unit))
    if alike:
        named = replace(named, indistinguishable_from=tuple(name for name in _SAME_FACTOR if name != best))
    return Comparison((named,), tuple(changes))


def _weigh(
    shift: FloatArray, weight: FloatArray, hypotheses: dict[str, FloatArray]
) -> tuple[dict[str, float], dict[str, FloatArray]]:
    """Chi squared that each hypothesis leaves of `shift`, with a penalty for its parameters, and those."""
    scores: dict[str, float] = {"": float(shift @ weight @ shift)}
    fitted: dict[str, FloatArray] = {}
    for name, span in hypotheses.items():
        normal = span.T @ weight @ span + 1e-12 * np.eye(span.shape[1])
        step = np.asarray(np.linalg.solve(normal, span.T @ weight @ shift), dtype=np.float64)
        rest = shift - span @ step
        scores[name], fitted[name] = float(rest @ weight @ rest) + _SIMPLER * span.shape[1], step
    return scores, fitted


def _named(
    name: str, step: FloatArray, span: FloatArray, covariance: FloatArray, context: tuple[RigidJoint, Plant, str]
) -> NamedEffect:
    given, plant, unit = context
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(span.T @ np.linalg.inv(covariance) @ span)))
    if name == "inertia_error":
        change, wide = given.inertia * float(np.exp(step[0]) - 1.0), given.inertia * float(half[0])
        numbers = {"inertia_change": Quantity(change, "kg·m²", (change - wide, change + wide))}
        return _effect(name, "parameter", numbers, f"the inertia is {plant.inertia:.4g} kg·m², not {given.inertia:.4g}")
    if name == "torque_gain_error":
        gain, wide = float(step[0]), float(half[0])
        numbers = {"gain_error": Quantity(gain, "1", (gain - wide, gain + wide))}
        return _effect(name, "measurement", numbers, f"the recorded torque is scaled by {1.0 + gain:.3f}")
    inertia, wide = plant.inertia - given.inertia, given.inertia * float(half[0])
    numbers = {
        "gravity_cos_change": Quantity(float(step[1]), unit, (float(step[1] - half[1]), float(step[1] + half[1]))),
        "gravity_sin_change": Quantity(float(step[2]), unit, (float(step[2] - half[2]), float(step[2] + half[2]))),
        "inertia_change": Quantity(inertia, "kg·m²", (inertia - wide, inertia + wide)),
    }
    return _effect(name, "parameter", numbers, "the load is not the simulation's")


def compare_friction(plant: Plant, covariance: FloatArray, given: FrictionModel, unit: str, doubt: Doubt) -> Comparison:
    """Compare offset and the symmetry of the friction with a given friction model.

    Args:
        plant: Refitted joint.
        covariance: Of the offset and the Coulomb torques forward and reverse. Shape (3, 3).
        given: The friction model.
        unit: Unit of torque.
        doubt: Of the refitted parameters.
    """
    try:
        forward, reverse = given.forward, given.reverse
    except ParameterError:
        return Comparison()
    level = max(0.5 * (forward.coulomb_torque + reverse.coulomb_torque), 1e-9)
    odd = 0.5 * ((plant.forward[0] - plant.reverse[0]) - (forward.coulomb_torque - reverse.coulomb_torque))
    effects = _uneven(np.array([plant.offset, odd]), covariance, (level, unit), doubt)
    deviations = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    changes = (
        _change(
            "forward.coulomb_torque",
            forward.coulomb_torque,
            plant.forward[0],
            float(deviations[1]),
            unit,
        ),
        _change(
            "reverse.coulomb_torque",
            reverse.coulomb_torque,
            plant.reverse[0],
            float(deviations[2]),
            unit,
        ),
    )
    return Comparison(effects, changes if effects else ())


def _uneven(
    shift: FloatArray, covariance: FloatArray, context: tuple[float, str], doubt: Doubt
) -> tuple[NamedEffect, ...]:
    """Names for a shift of offset and odd part of the Coulomb torque: one of the two where that is enough."""
    level = context[0]
    odd = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, -0.5]])
    sides = np.array([[0.5, 0.5], [0.5, -0.5]])  # offset and odd part, from their sum and their difference
    floor = sides @ np.diag([doubt.sliding * level, SPLIT * level]) ** 2 @ sides.T
    weight = np.linalg.inv(odd @ covariance @ odd.T + floor)
    names = ("torque_offset", "direction_asymmetry")
    both = "+".join(names)
    hypotheses = {names[0]: np.eye(2)[:, :1], names[1]: np.eye(2)[:, 1:], both: np.eye(2)}
    scores, fitted = _weigh(shift, weight, hypotheses)
    best = min(scores, key=lambda name: scores[name])
    if not best or scores[""] - scores[best] < _SIGNIFICANT:
        return ()
    alike = best != both and abs(scores[names[0]] - scores[names[1]]) <= _SIMPLER
    best = names[0] if alike else best  # an offset leaves the joint as it is
    span = hypotheses[best]
    half = 1.96 * np.sqrt(np.diag(np.linalg.inv(span.T @ weight @ span)))
    effects = [
        _uneven_effect(name, float(value), float(wide), context)
        for name, value, wide in zip(best.split("+"), fitted[best], half, strict=True)
    ]
    return tuple(replace(one, indistinguishable_from=names[1:] if alike else ()) for one in effects)


def _uneven_effect(name: str, value: float, half: float, context: tuple[float, str]) -> NamedEffect:
    level, unit = context
    if name == "torque_offset":
        numbers = {"offset": Quantity(value, unit, (value - half, value + half))}
        return _effect(name, "parameter", numbers, f"a constant torque of {value:.3g} {unit} is missing")
    ratio, wide = value / level, half / level
    numbers = {
        "asymmetry": Quantity(ratio, "1", (ratio - wide, ratio + wide)),
        "coulomb_difference": Quantity(2.0 * value, unit, (2.0 * (value - half), 2.0 * (value + half))),
    }
    sentence = f"friction differs between the directions by {200 * abs(ratio):.0f} %"
    return _effect(name, "parameter", numbers, sentence)


def _change(name: str, given: float, refitted: float, deviation: float, unit: str) -> Change:
    half = 1.96 * deviation
    return Change(name=name, given=given, refitted=Quantity(refitted, unit, (refitted - half, refitted + half)))


def _effect(name: str, kind: str, parameters: dict[str, Quantity], sentence: str) -> NamedEffect:
    return NamedEffect(name=name, kind=kind, parameters=parameters, sentence=sentence)  # type: ignore[arg-type]
