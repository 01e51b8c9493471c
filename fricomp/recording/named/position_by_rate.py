"""The position of a joint in a column whose name says nothing: that of which the velocity is the rate."""

from collections.abc import Collection, Mapping

import numpy as np

from fricomp.recording.quantity_word import says_asked_for
from fricomp.recording.validity import Samples

_SPANS = 200
"""Spans of the rows over which ways are compared: long ones, in which steps of an encoder are small."""
_LEAST_ALIKE = 0.98
"""Correlation of the ways from which on a column is the integral of another; a reference falls behind by its error."""


def find_position_by_rate(columns: Mapping[str, Samples], velocity: str, taken: Collection[str]) -> str:
    """Name of the column that the velocity is the rate of, of those whose names say nothing; empty where none is.

    Args:
        columns: All by name; shape (n_rows,) each.
        velocity: Name of the column with the velocity.
        taken: Names of columns that say what they hold.
    """
    rate = columns[velocity]
    likely = {
        name: _compare_ways(values, rate)
        for name, values in columns.items()
        if name not in taken and values.shape == rate.shape and not says_asked_for(name)
    }
    best = max(likely, key=lambda name: likely[name], default="")
    return best if best and likely[best] > _LEAST_ALIKE else ""


def is_rate_of(velocity: Samples, position: Samples) -> bool:
    """Whether one column is the rate of the other, in whatever units. Shape (n_rows,) each."""
    return velocity.shape == position.shape and _compare_ways(position, velocity) > _LEAST_ALIKE


def _compare_ways(values: Samples, rate: Samples) -> float:
    """Correlation of the ways of a column over many spans with the sums of its rate there. Shape (n_rows,) each."""
    known = np.isfinite(values) & np.isfinite(rate)
    values, rate = values[known], rate[known]
    span = max(values.size // _SPANS, 1)
    if values.size < 3 * span:
        return 0.0
    summed = np.cumsum(0.5 * (rate[1:] + rate[:-1]))
    ways = np.stack([values[1:][span:] - values[1:][:-span], summed[span:] - summed[:-span]])
    return 0.0 if np.any(np.ptp(ways, axis=1) == 0.0) else float(np.corrcoef(*ways)[0, 1])
