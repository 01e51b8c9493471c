"""What counts as a number where a joint is moved by it: a real one, finite, and not absurdly large."""

from numbers import Real
from typing import Any, TypeGuard

LARGEST_NUMBER = 1e12
"""Beyond every torque, speed, gain and time of a joint in SI [1]; products of such numbers do not overflow."""


def is_number(value: Any, lowest: float = -LARGEST_NUMBER, highest: float = LARGEST_NUMBER) -> TypeGuard[float]:
    """Whether a value is a real number from `lowest` to `highest`; True, text and NaN are not."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    number: Any = value  # numpy's are real numbers as well
    return bool(lowest <= number <= highest)
