"""A channel whose unit changes within the recording: its values and its steps become another multiple at one row."""

from collections.abc import Mapping

import numpy as np

from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_THOUSAND = 1000.0
_FACTORS = {
    180.0 / np.pi: "as from radians to degrees",
    360.0: "as from turns to degrees",
    _THOUSAND: "as from a unit to thousandths of it",
}
"""Factors between units that are taken for each other, and what they mean. Smaller ones, as from turns to radians, are
no more than what a quick motion after a slow one may do."""
_LARGE = 20.0
"""Step over the usual one beside it, from which on a row is looked at: knocks and reversals are smaller."""
_NEAR = 4.0
"""Usual steps, of the larger unit, by which the value after the change may miss the factor: the joint moves on."""
_ALIKE = 3.0
"""Factor by which the ratio of the usual steps may miss that of the units: the motion is not the same before and
after."""
_BESIDE = 20
"""Rows to either side that tell the usual step at a row."""
_LEAST_STEP = 0.1
"""Part of the usual step of all rows that the usual one at a row has at least, where the joint rests."""
_FEWEST = 100
"""Rows that each unit must have had."""
_RANGE = 30.0
"""Usual steps that each unit must have gone through: noise at rest before a motion goes through some five."""
_MOST_ROWS = 20
"""Steps that are looked at, those first that are the largest beside the usual ones around them."""


def find_unit_change(recording: Recording) -> tuple[Finding, ...]:
    """A channel that changes its unit at one row, both in size and in how far it moves a row."""
    for name in ("position", "velocity", "torque"):
        values = recording.channels.get(name)
        factors = _FACTORS if name != "torque" else {_THOUSAND: _FACTORS[_THOUSAND]}  # no torque is in degrees
        change = None if values is None else _locate_change(recording, np.asarray(values), factors)
        if change is not None and (name != "velocity" or _position_says_so(recording, *change[:2])):
            row, factor, meaning = change
            at = float(recording.time[row])
            message = (
                f"{name} is {factor:.4g} times as large from {at:.3f} s on, in its values and in its steps, {meaning}: "
                "its unit changes"
            )
            advice = f"take what is in one unit (--to {at:.3f} or --from {at:.3f}), or convert the other rows first"
            return (Finding("unit_change", "error", message, advice, row + 1, name),)
    return ()


def _position_says_so(recording: Recording, row: int, factor: float) -> bool:
    """Whether the velocity becomes another multiple of how fast the position moves: a joint that sticks does not."""
    moved, said = np.abs(np.diff(recording.position)), np.abs(recording.channels["velocity"][1:])
    before, after = (np.sum(moved[part]) / (np.sum(said[part]) + 1e-300) for part in (slice(row), slice(row, None)))
    return bool(before < _ALIKE * factor * after and factor * after < _ALIKE * before)


def _locate_change(
    recording: Recording, values: Samples, factors: Mapping[float, str]
) -> tuple[int, float, str] | None:
    """First row in the new unit, the factor, and what it means; None where there is none."""
    step = np.where(np.diff(recording.time) > find_gap_length(recording), 0.0, np.diff(values))
    size = np.abs(step)
    if size.size <= 2 * _FEWEST or not size.any():
        return None
    before, after = _usual_steps(size)
    larger = size / np.minimum(before, after)
    for k in (_FEWEST + np.argsort(larger[_FEWEST:-_FEWEST])[::-1][:_MOST_ROWS]).tolist():
        if larger[k] < _LARGE:
            break
        long_before, long_after = _usual_step(size[:k]), _usual_step(size[k + 1 :])
        if min(np.ptp(values[: k + 1]) / long_before, np.ptp(values[k + 1 :]) / long_after) < _RANGE:
            continue
        for greater, meaning in factors.items():
            for factor in (greater, 1.0 / greater):
                missed = abs(values[k + 1] - factor * values[k])
                fits = missed <= _NEAR * max(after[k], factor * before[k]) and missed < 0.5 * size[k]
                if not fits:
                    continue
                steps = ((long_before, long_after), (_large_step(size[:k]), _large_step(size[k + 1 :])))
                if all(1.0 / _ALIKE < now / (factor * then) < _ALIKE for then, now in steps):
                    return k + 1, factor, meaning if factor > 1.0 else f"{meaning} and back"
    return None


def _usual_steps(size: Samples) -> tuple[Samples, Samples]:
    """Mean of the steps before and after each step, which at rest would be that of nothing. Shapes (n,)."""
    total = np.concatenate([[0.0], np.cumsum(size)])
    row = np.arange(size.size)
    first, last = np.maximum(row - _BESIDE, 0), np.minimum(row + 1 + _BESIDE, size.size)
    before = (total[row] - total[first]) / np.maximum(row - first, 1)
    after = (total[last] - total[row + 1]) / np.maximum(last - row - 1, 1)
    least = _LEAST_STEP * float(np.median(size[size > 0.0]))
    return np.maximum(before, least), np.maximum(after, least)


def _usual_step(size: Samples) -> float:
    """Mean of the steps that are none of the largest tenth: an encoder makes most of them zero."""
    return float(np.mean(np.sort(size)[: max(1, round(0.9 * size.size))])) + 1e-300


def _large_step(size: Samples) -> float:
    """A step larger than nearly all: those of a joint that comes to rest stay, those of another unit do not."""
    return float(np.quantile(size, 0.99)) + 1e-300
