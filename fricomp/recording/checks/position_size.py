"""A position with its sign in a bit of its register, as Feetech's servos have it below their zero."""

import numpy as np

from fricomp.recording.validity import Samples

from .quantum import measure_quantum

_SIGN_BITS = range(7, 32)
"""Bits, counted from 0, in which a register may have its sign."""
_LEAP = 0.4
"""Part of the largest number from which on a step is one from below the sign to above it."""
_NEAR = 0.1
"""Part of the way on each side within which such a step begins and ends: a counter that wraps ends at the far end."""
_AT_ZERO = 8.0
"""Usual steps within which the joint passes its zero between two rows."""
_USUAL = 0.95
"""Quantile of the steps from row to row that are usual."""
_MOST_LEVELS = 0.9
"""Different values over rows up to which the step of the numbers is looked for."""


def find_sign_bit(position: Samples) -> tuple[int, float] | None:
    """The bit of a position's register with its sign, and what one of its counts is; None where none is seen.

    Sizes of both signs begin at zero: of those with the bit set, at its worth. All steps between both lead from one
    beginning to the other, where a counter that wraps leads from one end to the other end.

    Args:
        position: Shape (n_rows,), in any unit, zero where the register is.
    """
    values = position[np.isfinite(position)]
    if values.size < 3 or values.min() < 0.0:
        return None
    steps = np.abs(np.diff(values))
    leaps = np.flatnonzero(steps > _LEAP * values.max())
    others = np.delete(steps, leaps)
    if not leaps.size or not others.any():
        return None
    usual = float(np.quantile(others[others > 0.0], _USUAL))
    lower, upper = values[values < 0.5 * values.max()], values[values >= 0.5 * values.max()]
    if not lower.size or upper.max() - upper.min() < _AT_ZERO * usual:
        return None
    ends = np.sort(np.stack([values[leaps], values[leaps + 1]]), axis=0)
    from_zero, from_bit = float(np.max(ends[0])), float(np.max(ends[1] - upper.min()))
    widths = float(lower.max()), float(upper.max() - upper.min())
    if from_zero > _AT_ZERO * usual or from_bit > min(_AT_ZERO * usual, max(_NEAR * widths[1], 2.0 * usual)):
        return None
    return _find_bit(float(upper.min()), measure_quantum(values, _MOST_LEVELS), _AT_ZERO * usual)


def _find_bit(least: float, quantum: float, reach: float) -> tuple[int, float] | None:
    """The bit whose worth in counts is just below the least of the larger numbers; None where none is."""
    if quantum <= 0.0:
        return None
    for bit in _SIGN_BITS:
        above = least - 2.0**bit * quantum
        if -quantum < above <= reach:
            return bit, quantum
    return None


def turn_sizes(position: Samples, bit: int, quantum: float) -> Samples:
    """The position below zero where its sign is set. Shape (n_rows,).

    Args:
        position: Shape (n_rows,).
        bit: That holds the sign.
        quantum: What one count is, in the unit of the position.
    """
    base = 2.0**bit * quantum
    return np.where(position >= base - 0.5 * quantum, base - position, position)
