"""How many rows come a second, by a position and the velocity beside it, where no column is a time."""

from collections.abc import Mapping

import numpy as np

from fricomp.recording.named.column import read_column_name
from fricomp.recording.unit import UNITS
from fricomp.recording.validity import Samples

_BLOCKS, _FEWEST = 1000, 20
"""Blocks of rows over which ways are compared, and how few of them tell nothing."""
_ALIKE = 0.97
"""Correlation of the way with the sum of the velocity from which on one is of the other."""
_WHOLE = 0.01
"""Relative distance to a whole number within which the rate is that."""


def estimate_row_rate(columns: Mapping[str, Samples], position: str, velocity: str) -> float | None:
    """Rows a second [Hz] by which the velocity is the rate of the position; None where it is not.

    Args:
        columns: All by name; shape (n_rows,) each.
        position: Name of one; where it states no unit it is in that of the velocity times a second.
        velocity: Name of another.
    """
    units = [_read_unit(name) for name in (position, velocity)]
    if any(unit and unit not in UNITS for unit in units):
        return None
    worth = [UNITS[unit].factor if unit else 1.0 for unit in units]
    return _compare(worth[0] * columns[position], worth[1] * columns[velocity])


def _read_unit(name: str) -> str:
    meaning = read_column_name(name)
    return "" if meaning is None else meaning.unit


def _compare(position: Samples, velocity: Samples) -> float | None:
    width = max(1, position.size // _BLOCKS)
    marks = np.arange(0, position.size, width)
    if marks.size < _FEWEST or not (np.isfinite(position).all() and np.isfinite(velocity).all()):
        return None
    path = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))])
    moved, summed = np.diff(position[marks]), np.diff(path[marks])
    both = float(moved @ summed)
    size = float(np.sqrt((moved @ moved) * (summed @ summed)))
    if size == 0.0 or both < _ALIKE * size:
        return None
    rate = float(summed @ summed) / both
    return float(round(rate)) if abs(rate / max(round(rate), 1) - 1.0) < _WHOLE else float(f"{rate:.4g}")


def say_row_rate(columns: Mapping[str, Samples]) -> str:
    """Which rate the names of a log without a time make of its position and velocity; empty where they tell none.

    Args:
        columns: All by name; shape (n_rows,) each.
    """
    meanings = {name: one for name in columns if (one := read_column_name(name)) is not None}
    positions = [name for name, one in meanings.items() if one.channel == "position"]
    velocities = [name for name, one in meanings.items() if one.channel == "velocity"]
    rate = estimate_row_rate(columns, positions[0], velocities[0]) if len(positions) == len(velocities) == 1 else None
    if rate is None:
        return ""
    agree = "" if all(map(_read_unit, (positions[0], velocities[0]))) else ", if they are in one unit"
    return f"; {positions[0]!r} beside {velocities[0]!r} says --row-rate {rate:g}{agree}"
