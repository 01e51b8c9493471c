"""Units by name, and what they are worth in SI; what the step of an encoder tells of one.

Factors are exact by definition, pound-force and inch included [nist811].
"""

from math import log10, pi
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.validity import Samples

_POUND_FORCE = 4.4482216152605
_INCH = 0.0254
_NEAR_LEVELS = 50.0
"""Steps between two levels within which their number is sure."""
_MANY = 200_000
"""Rows of a position by which its step is told; of more, every second, third or later one."""
_MOST_COUNTS = 200_000
"""Counts a turn of an encoder whose step is told by them."""


class Unit(NamedTuple):
    """A unit: value in SI = factor * value + offset.

    Attributes:
        factor: SI units in one of these.
        si: Name of the SI unit of the same quantity.
        offset: SI value at zero; only temperatures have one.
    """

    factor: float
    si: str
    offset: float = 0.0


UNITS = {
    "1": Unit(1.0, "1"),
    "percent": Unit(0.01, "1"),
    "s": Unit(1.0, "s"),
    "ms": Unit(1e-3, "s"),
    "us": Unit(1e-6, "s"),
    "ns": Unit(1e-9, "s"),
    "100ns": Unit(1e-7, "s"),
    "min": Unit(60.0, "s"),
    "h": Unit(3600.0, "s"),
    "d": Unit(86400.0, "s"),
    "rad": Unit(1.0, "rad"),
    "urad": Unit(1e-6, "rad"),
    "mrad": Unit(1e-3, "rad"),
    "deg": Unit(pi / 180, "rad"),
    "mdeg": Unit(pi / 180e3, "rad"),
    "cdeg": Unit(pi / 180e2, "rad"),
    "gon": Unit(pi / 200, "rad"),
    "arcmin": Unit(pi / 10800, "rad"),
    "arcsec": Unit(pi / 648000, "rad"),
    "turns": Unit(2 * pi, "rad"),
    "mturns": Unit(2e-3 * pi, "rad"),
    "m": Unit(1.0, "m"),
    "mm": Unit(1e-3, "m"),
    "cm": Unit(1e-2, "m"),
    "um": Unit(1e-6, "m"),
    "in": Unit(_INCH, "m"),
    "rad/s": Unit(1.0, "rad/s"),
    "mrad/s": Unit(1e-3, "rad/s"),
    "deg/s": Unit(pi / 180, "rad/s"),
    "mdeg/s": Unit(pi / 180e3, "rad/s"),
    "rpm": Unit(2 * pi / 60, "rad/s"),
    "krpm": Unit(2e3 * pi / 60, "rad/s"),
    "turns/s": Unit(2 * pi, "rad/s"),
    "m/s": Unit(1.0, "m/s"),
    "mm/s": Unit(1e-3, "m/s"),
    "cm/s": Unit(1e-2, "m/s"),
    "in/s": Unit(_INCH, "m/s"),
    "rad/s^2": Unit(1.0, "rad/s²"),
    "deg/s^2": Unit(pi / 180, "rad/s²"),
    "m/s^2": Unit(1.0, "m/s²"),
    "mm/s^2": Unit(1e-3, "m/s²"),
    "N·m": Unit(1.0, "N·m"),
    "Nm": Unit(1.0, "N·m"),
    "mNm": Unit(1e-3, "N·m"),
    "Ncm": Unit(1e-2, "N·m"),
    "kNm": Unit(1e3, "N·m"),
    "daNm": Unit(10.0, "N·m"),
    "kgf·cm": Unit(9.80665e-2, "N·m"),
    "kgf·m": Unit(9.80665, "N·m"),
    "gf·cm": Unit(9.80665e-5, "N·m"),
    "uNm": Unit(1e-6, "N·m"),
    "in·lbf": Unit(_INCH * _POUND_FORCE, "N·m"),
    "ft·lbf": Unit(12 * _INCH * _POUND_FORCE, "N·m"),
    "oz·in": Unit(_INCH * _POUND_FORCE / 16, "N·m"),
    "N": Unit(1.0, "N"),
    "kN": Unit(1e3, "N"),
    "daN": Unit(10.0, "N"),
    "lbf": Unit(_POUND_FORCE, "N"),
    "kip": Unit(1e3 * _POUND_FORCE, "N"),
    "kgf": Unit(9.80665, "N"),
    "A": Unit(1.0, "A"),
    "mA": Unit(1e-3, "A"),
    "V": Unit(1.0, "V"),
    "mV": Unit(1e-3, "V"),
    "degC": Unit(1.0, "°C"),
    "K": Unit(1.0, "°C", -273.15),
    "degF": Unit(5 / 9, "°C", -160 / 9),
}


def find_unit(name: str) -> Unit:
    """Return the unit of this name.

    Raises:
        RecordingError: The name is not in `UNITS`.
    """
    if name not in UNITS:
        raise RecordingError(f"unknown unit {name!r}: valid are {', '.join(UNITS)}; or give a scale")
    return UNITS[name]


def find_position_step(position: Samples) -> float | None:
    """Return the step of a quantised position [as position], or None where it is not quantised."""
    levels = np.unique(position[:: max(1, position.size // _MANY)])
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(np.abs(levels).max(), 1e-300)]
    if gaps.size < 20:
        return None
    step = float(np.median(gaps[gaps < 1.5 * gaps.min()]))
    near = gaps[gaps < _NEAR_LEVELS * step]
    step = float(near.sum() / np.round(near / step).sum())  # numbers written with few decimals round each gap
    whole = np.abs(gaps / step - np.round(gaps / step)) < 0.02
    return step if whole.mean() > 0.98 else None


def shows_radians(position: Samples) -> bool:
    """Whether a position [rad] moves in steps of an encoder whose turn is 2 pi. Shape (n_samples,)."""
    step = find_position_step(position)
    if step is None or is_rounding(step):
        return False
    counts = round(2.0 * pi / step)
    binary = 256 <= counts < 2**27 and counts & (counts - 1) == 0
    return (binary or is_round(counts)) and abs(counts * step / (2.0 * pi) - 1.0) < 1e-5


def is_round(counts: int) -> bool:
    """Whether an encoder has so many counts a turn, as far as those in hundreds go."""
    return 0 < counts <= _MOST_COUNTS and counts % 100 == 0


def is_rounding(step: float) -> bool:
    """Whether a step is that of numbers written with so many decimals, which may be of anything."""
    return abs(log10(step) - round(log10(step))) < 1e-6
