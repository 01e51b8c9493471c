"""Jumps of a position: a counter that wraps round, a zero that is set anew, a value that stands for none."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.new_zero import find_new_zeros
from fricomp.recording.checks.position_size import find_sign_bit
from fricomp.recording.checks.quantum import ONE_TURN, TURN_IN_DEGREES, measure_quantum, snap_period
from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_FEWEST_ROWS = 20  # of a position, below which no row of it is told to be alone
_WRAP_FACTOR = 10.0  # a wrap is so many times larger than the steps around it
_JUMP_FACTOR = 30.0
_LEAST_LEAP = 0.1  # part of the range of all others, below which a lone sample beyond it may be noise or a knock
_PLACEHOLDERS = 0.2  # part of the rows that hold a number for no value, above which the log is something else


def find_position_jumps(recording: Recording) -> tuple[Finding, ...]:
    """Jumps of position, the first kind of which there is one.

    It jumps to a value that stands for none, by a turn, by the whole range of a counter, or by any other way.
    """
    signed = find_sign_bit(np.asarray(recording.position))
    if signed is not None:
        return (_describe_sign(signed[0]),)
    lone = _find_lone(np.asarray(recording.position))
    apart = (np.diff(recording.time) > find_gap_length(recording)) | lone[1:] | lone[:-1]
    step = np.where(apart, 0.0, np.diff(recording.position))
    size = np.abs(step)
    if not size.any():
        return ()
    usual = np.maximum(np.percentile(size[size > 0], 90), _around(size))
    travel = float(np.ptp(recording.position[~lone]))
    turn = 2 * np.pi if recording.metadata.motion == "rotary" else np.inf
    near_turn = np.abs(size - turn) < 0.1 * turn
    near_range = size > 0.95 * travel
    wraps = np.flatnonzero((near_turn | near_range) & (size > _WRAP_FACTOR * usual))
    if wraps.size:
        standing = _find_placeholder(recording.position, float(size[wraps[0]]))
        if standing is not None:
            return (_describe_placeholder(recording.position, standing),)
        return (_describe_wrap(recording, step, wraps, "2π" if near_turn[wraps[0]] else "its whole range"),)
    rate = size / np.maximum(np.diff(recording.time) / recording.sample_period, 1.0)  # a gap in time is no jump
    jumps = np.flatnonzero((rate > _JUMP_FACTOR * usual) & (size > 0.01 * travel))
    return (_describe_jump(recording, int(jumps[0]), step, usual),) if jumps.size else ()


def _describe_sign(bit: int) -> Finding:
    message = f"position is stored as a size, with its sign in bit {bit} of its register, and was read as one number"
    advice = (
        f"write sign_bit = {bit} into the channel of a mapping where its column holds the counts ('fricomp convert LOG "
        "--inspect' has a mapping to edit); velocity and load of the same device may need one as well"
    )
    return Finding("sign_bit", "error", message, advice, column="position")


def _describe_placeholder(position: Samples, standing: float) -> Finding:
    rows = np.flatnonzero(position == standing)
    message = f"position is {standing:.6g} in {rows.size} row(s), far from all others: it stands for no value"
    advice = "leave these rows out; identify and diagnose do so by themselves"
    return Finding("spike", "warning", message, advice, int(rows[0]) + 1, "position")


def _describe_wrap(recording: Recording, step: Samples, wraps: NDArray[np.int_], what: str) -> Finding:
    """A position that wraps round, and its unit where it does so at one turn of another unit.

    Args:
        recording: Whose position it is.
        step: From each sample to the next. Shape (n_samples - 1,).
        wraps: Where in `step` the position wraps.
        what: How far it jumps, in words.
    """
    row = int(wraps[0])
    passed = float(np.median(np.abs(step)[max(row - 2, 0) : row + 3]))  # the way of the joint itself within the step
    period = snap_period(float(np.abs(step[row])) + passed, measure_quantum(np.asarray(recording.position)))
    if recording.metadata.motion == "rotary" and period == TURN_IN_DEGREES:
        message = f"position wraps round at 360, {wraps.size} time(s): factor 57.3, it is in degrees"
        advice = 'multiply by π/180 and unwrap it (unit = "deg", unwrap = 6.28319 in a mapping)'
        return Finding("degrees", "error", message, advice, row + 2, "position")
    if recording.metadata.motion == "rotary" and period == ONE_TURN:
        message = f"position wraps round at 1, {wraps.size} time(s): factor 6.28, it is in turns"
        advice = 'multiply by 2π and unwrap it (unit = "turns", unwrap = 6.28319 in a mapping)'
        return Finding("turns", "error", message, advice, row + 2, "position")
    message = f"position jumps by {step[row]:.5g}, {what}, {wraps.size} time(s): it wraps round"
    return Finding("wrap", "error", message, f"unwrap it (unwrap = {period:.6g} in a mapping)", row + 2, "position")


def _describe_jump(recording: Recording, row: int, step: Samples, usual: Samples) -> Finding:
    """A jump of the position behind `row`, whose steps and usual steps have shape (n_samples - 1,)."""
    unit = recording.metadata.position_unit
    if row in find_new_zeros(recording):
        message = (
            f"the zero of position is set anew: it jumps by {step[row]:.5g} {unit} and the joint goes on as before"
        )
        advice = "identify and diagnose move what is before it"
        return Finding("jump", "warning", message, advice, row + 2, "position")
    message = f"position jumps by {step[row]:.5g} {unit} where {usual[row]:.2g} is usual"
    return Finding("jump", "warning", message, "look for lost samples; split there", row + 2, "position")


def _find_lone(position: Samples) -> NDArray[np.bool_]:
    """Rows outside the range of all others, to which the position leaps and from which it comes straight back.

    A counter that wraps stays within its range, and one value that stands for none is told as such. Shape (n_samples,).
    """
    lone = np.zeros(position.size, dtype=bool)
    if position.size < _FEWEST_ROWS:
        return lone
    before, after = np.diff(position)[:-1], np.diff(position)[1:]
    back = (before * after < 0.0) & (np.minimum(np.abs(before), np.abs(after)) > _JUMP_FACTOR * np.abs(before + after))
    lone[1:-1] = back
    low, high = np.min(position, where=~lone, initial=np.inf), np.max(position, where=~lone, initial=-np.inf)
    lone &= (position < low) | (position > high)
    far = np.abs(position - np.clip(position, low, high))
    lone &= far > _LEAST_LEAP * (high - low)
    return lone if np.unique(position[lone]).size == np.count_nonzero(lone) else np.zeros_like(lone)


def _find_placeholder(position: Samples, size: float) -> float | None:
    """The one value that all rows far from the usual position have, such as -9999; None where they have several.

    Beyond a wrap a joint goes on moving.

    Args:
        position: Shape (n_samples,).
        size: How far the position jumps.
    """
    far = position[np.abs(position - np.median(position)) > 0.5 * size]
    few = 1 < far.size <= _PLACEHOLDERS * position.size
    return float(far[0]) if few and np.all(far == far[0]) else None


def _around(size: Samples) -> Samples:
    """Median of the two steps before and the two after each step; a fast part is no jump in a slow recording."""
    padded = np.pad(size, 2, mode="edge")
    shifts = [padded[k : k + size.size] for k in (0, 1, 3, 4)]
    return np.asarray(np.median(np.stack(shifts), axis=0), dtype=np.float64)
