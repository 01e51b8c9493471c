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

__all__ = ["Comparison", "compare_friction", "compare_rigid"]

_TOLERANCE = 0.005  # relative error of a parameter that the observer's own approximations may cause
_SAME_FACTOR = ("payload_error", "torque_gain_error")
_USUAL_GAIN = 0.1  # largest gain error of a torque signal that is usual; masses are off by more
_SIGNIFICANT = 25.0  # fall of chi squared that a change must bring


@dataclass(frozen=True)
class Comparison:
    """Parameters that differ from the given ones."""

    effects: tuple[NamedEffect, ...] = ()
    changes: tuple[Change, ...] = ()


def compare_rigid(plant: Plant, covariance: FloatArray, given: RigidJoint, unit: str) -> Comparison:
    """Compare inertia and gravity with the simulation's.

    Args:
        plant: Refitted joint.
        covariance: Of log inertia and the two gravity coefficients. Shape (3, 3).
        given: The simulation.
        unit: Unit of torque.
    """
    gravity = float(np.hypot(*given.gravity))
    refit = np.array([log(plant.inertia), *plant.gravity])
    prior = np.array([log(given.inertia), *given.gravity])
    floor = np.diag([_TOLERANCE, *([_TOLERANCE * max(gravity, 1e-9)] * 2)]) ** 2
    # Gravity far below friction says nothing about a gain: the floor keeps chi squared from tiny biases.
    weight = np.linalg.inv(covariance + floor)
    shift = refit - prior
    hypotheses = {
        "inertia_error": np.array([[1.0, 0.0, 0.0]]).T,
        "payload_error": np.eye(3),
        "torque_gain_error": np.array([[1.0, *given.gravity]]).T,
    }
    scores = {"": float(shift @ weight @ shift)}
    fitted: dict[str, FloatArray] = {}
    for name, span in hypotheses.items():
        step = np.linalg.solve(span.T @ weight @ span + 1e-12 * np.eye(span.shape[1]), span.T @ weight @ shift)
        rest = shift - span @ step
        scores[name], fitted[name] = float(rest @ weight @ rest) + 4.0 * span.shape[1], step
    best = min(scores, key=lambda name: scores[name])
    if not best or scores[""] - scores[best] < _SIGNIFICANT:
        return Comparison()
    # Inertia and gravity that are off by the same factor are a gain as well as another mass.
    alike = best in _SAME_FACTOR and scores["torque_gain_error"] <= scores["payload_error"] + 4.0
    if alike:
        best = "torque_gain_error" if abs(float(fitted["torque_gain_error"][0])) <= _USUAL_GAIN else "payload_error"
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


def compare_friction(plant: Plant, deviations: dict[str, float], given: FrictionModel, unit: str) -> Comparison:
    """Compare offset and the symmetry of the friction with a given friction model."""
    try:
        forward, reverse = given.forward, given.reverse
    except ParameterError:
        return Comparison()
    level = 0.5 * (forward.coulomb_torque + reverse.coulomb_torque)
    effects: list[NamedEffect] = []
    odd = 0.5 * ((plant.forward[0] - plant.reverse[0]) - (forward.coulomb_torque - reverse.coulomb_torque))
    odd_deviation = 0.5 * float(np.hypot(deviations["forward.coulomb_torque"], deviations["reverse.coulomb_torque"]))
    if abs(odd) > max(4.0 * odd_deviation, 0.01 * level):
        ratio = float(odd / max(level, 1e-9))
        wide = 1.96 * odd_deviation / max(level, 1e-9)
        effects.append(
            _effect(
                "direction_asymmetry",
                "parameter",
                {"asymmetry": Quantity(ratio, "1", (ratio - wide, ratio + wide))},
                f"friction differs between the directions by {200 * abs(ratio):.0f} %",
            )
        )
    offset, deviation = plant.offset, deviations["offset"]
    if abs(offset) > max(4.0 * deviation, 0.01 * level):
        wide = 1.96 * deviation
        effects.append(
            _effect(
                "torque_offset",
                "parameter",
                {"offset": Quantity(offset, unit, (offset - wide, offset + wide))},
                f"a constant torque of {offset:.3g} {unit} is missing",
            )
        )
    changes = (
        _change(
            "forward.coulomb_torque",
            forward.coulomb_torque,
            plant.forward[0],
            deviations["forward.coulomb_torque"],
            unit,
        ),
        _change(
            "reverse.coulomb_torque",
            reverse.coulomb_torque,
            plant.reverse[0],
            deviations["reverse.coulomb_torque"],
            unit,
        ),
    )
    return Comparison(tuple(effects), changes if effects else ())


def _change(name: str, given: float, refitted: float, deviation: float, unit: str) -> Change:
    half = 1.96 * deviation
    return Change(name=name, given=given, refitted=Quantity(refitted, unit, (refitted - half, refitted + half)))


def _effect(name: str, kind: str, parameters: dict[str, Quantity], sentence: str) -> NamedEffect:
    return NamedEffect(name=name, kind=kind, parameters=parameters, sentence=sentence)  # type: ignore[arg-type]
