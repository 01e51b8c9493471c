"""Numbers that recordings do not determine: what they may be is more than they are, and makes a difference."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricomp.root_mean_square import compute_rms

from ..effects.effect import EffectParameter
from ..effects.settings import EFFECT
from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES
from ..record.result import Quantity
from .refitted import SPLIT_BY_PRESLIDING, RefittedJoint
from .settings import UNDETERMINED

_LARGEST = 100.0
"""Logarithm of a factor from which on it is without end."""

_PHASE = ("sine", "cosine")
"""Parts of a wave, of which one may be zero without the other being so."""


def list_undetermined(refitted: RefittedJoint, units: tuple[str, str]) -> tuple[str, ...]:
    """Names of the numbers of body and friction, and of effects as `effect.number`, that are not determined.

    Args:
        refitted: The joint that the verdict is about.
        units: Of torque and of position.
    """
    found = [name for name, size in _measure_sizes(refitted).items() if _is_open(refitted, name, size)]
    for owner in refitted.structure.names:
        numbers = refitted.list_parameters(owner, *units, fit_alone=True)
        own = [one for name, one in refitted.structure.parameters if name == owner and one.name in numbers]
        found += [f"{owner}.{one.name}" for one in own if is_open_of_effect(one, numbers)]
    return tuple(found)


def cancels_with_gravity(refitted: RefittedJoint) -> bool:
    """Whether what sliding shows of a constant torque, with the difference of the directions, may all be gravity, as
    over a small angle."""
    line: FloatArray = np.zeros(refitted.fit.theta.size)
    line[[BASE_NAMES.index(name) for name in SPLIT_BY_PRESLIDING]] = 1.0, 0.5, -0.5
    half = 1.96 * float(np.sqrt(max(float(line @ refitted.covariance @ line), 0.0)))
    return _may_be_nothing(half, float(line @ refitted.fit.theta), _measure_sizes(refitted)["offset"])


def _measure_sizes(refitted: RefittedJoint) -> dict[str, float]:
    """Torque that a unit of each number makes in these motions, over the deviation of the recorded torque.

    That of the inertia plays no part: a simulation needs its value, however little torque it makes.
    """
    contexts = refitted.structure.contexts
    position: FloatArray = np.concatenate([one.position for one in contexts])
    velocity: FloatArray = np.concatenate([one.velocity for one in contexts])
    recorded = max(float(np.std(np.concatenate([one.recorded for one in contexts]))), 1e-300)
    columns: dict[str, FloatArray] = {"offset": np.ones(position.size)}
    if contexts[0].rotary:
        columns |= {"gravity_cos": np.cos(position), "gravity_sin": np.sin(position)}
    for side, rows in (("forward", velocity > 0.0), ("reverse", velocity < 0.0)):
        columns[f"{side}.coulomb_torque"] = rows.astype(np.float64)
        columns[f"{side}.viscous_coefficient"] = np.where(rows, velocity, 0.0)
    sizes = {name: compute_rms(column) / recorded for name, column in columns.items()}
    return {"inertia": np.inf, **sizes}


def _is_open(refitted: RefittedJoint, name: str, size: float) -> bool:
    """Whether a number of the base is not determined by the fit alone.

    How a constant torque and a difference between the directions share their sum is a matter of presliding in any
    recording, and is told by the intervals.
    """
    if name == "inertia":
        factor = 1.96 * float(refitted.deviations[BASE_NAMES.index("log_inertia")])
        return bool(np.sinh(min(factor, _LARGEST)) > UNDETERMINED.ratio)
    index = BASE_NAMES.index(name)
    return _may_be_nothing(1.96 * float(refitted.deviations[index]), float(refitted.fit.theta[index]), size)


def _may_be_nothing(half: float, value: float, size: float) -> bool:
    """Whether a number may be nothing or twice itself, and that matters in these motions."""
    return half > UNDETERMINED.ratio * abs(value) and half * size > UNDETERMINED.matters


def is_open_of_effect(parameter: EffectParameter, numbers: Mapping[str, Quantity]) -> bool:
    """Whether a number of an effect may be nearly all that is looked for, or twice and next to nothing of itself."""
    if parameter.name.startswith(_PHASE) or parameter.scale <= 0.0:
        return False
    quantity = numbers[parameter.name]
    (low, high), value = quantity.ci95, quantity.value
    if parameter.logarithmic or parameter.lower >= 0.0:
        known = np.isfinite(high) and 0.5 * (high - low) <= UNDETERMINED.ratio * abs(value)
        if not known:
            return True
    if max(-parameter.lower, parameter.upper) >= EFFECT.unbounded:
        return False
    if parameter.logarithmic:
        low, high = np.log(max(low, 1e-300)), np.log(max(high, 1e-300))
    return bool(high - low >= UNDETERMINED.domain * (parameter.upper - parameter.lower))
