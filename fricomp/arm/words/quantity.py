"""Numbers in sentences and tables, with their intervals."""

from __future__ import annotations

import math

from fricomp.diagnosis.record.result import Quantity
from fricomp.overview import AT_BOUND

_MOST_DIGITS = 6
"""Of a number in a sentence."""


def show_quantity(quantity: Quantity) -> str:
    """A value with its unit and interval, in as many digits as tell the ends of the interval apart."""
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    bound = f", {AT_BOUND}" if quantity.at_bound else ""
    return f"{quantity.value:.{_count_digits(quantity)}g}{unit} ({show_interval(quantity)}{bound})"


def show_interval(quantity: Quantity) -> str:
    """The interval alone, in as many digits."""
    digits = _count_digits(quantity)
    return " to ".join(f"{end:.{digits}g}" for end in quantity.ci95)


def show_share(part: float) -> str:
    """A part of something in per cent."""
    return f"{part:.0%}" if part >= 0.005 else "less than 1%"


def _count_digits(quantity: Quantity) -> int:
    low, high = quantity.ci95
    size, width = max(abs(low), abs(high), abs(quantity.value)), high - low
    return 3 if width <= 0.0 else min(max(3, math.ceil(math.log10(max(size / width, 1.0))) + 1), _MOST_DIGITS)
