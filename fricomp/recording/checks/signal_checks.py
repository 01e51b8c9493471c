"""Checks of single channels: no motion, stuck values, wraps, jumps and spikes."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.new_zero import find_new_zeros
from fricomp.recording.checks.quantum import ONE_TURN, TURN_IN_DEGREES, measure_quantum, read_at_rest, snap_period
from fricomp.recording.checks.timing_checks import GAP_PERIODS, find_gap_length
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_position_step

Samples = NDArray[np.float64]

_FEW_STEPS = 20  # encoder steps of travel below which only presliding can be seen
_REST_PART = 0.5  # part of the time at rest that deserves a word
_STUCK_TIME = 0.25  # [s]
_STUCK_ROWS = 20
_IDLE_TIME = 2.0  # [s] of a torque of exactly zero in motion; a held reading is no drive that is off
_STUCK_TRAVEL = 0.05  # part of the travel covered while the channel stands still
_STUCK_SHARE = 0.02  # step of a channel over its deviation, above which it may keep a value for long
_BEYOND_LAG = 2.0  # usual distances from the reference, that it must move while the position stays
_WRAP_FACTOR = 10.0  # a wrap is so many times larger than the steps around it
_JUMP_FACTOR = 30.0
_LEAST_LEAP = 0.1  # part of the range of all others, below which a lone sample beyond it may be noise or a knock
_PLACEHOLDERS = 0.2  # part of the rows that hold a number for no value, above which the log is something else
_SPIKE_FACTOR = 25.0
_SPIKES_ARE = {
    "position": "identify and diagnose leave these rows out",
    "torque": "identify and diagnose leave out those that the joint does not answer by its acceleration",
}


def find_rest(recording: Recording) -> tuple[Finding, ...]:
    """No motion at all, motion of a few encoder steps, or mostly rest."""
    position = recording.position
    travel = float(np.ptp(position))
    unit = recording.metadata.position_unit
    if travel == 0:
        message = f"the joint never moves: position is {position[0]:g} {unit} throughout"
        return (Finding("no_motion", "error", message, "record a motion", column="position"),)
    step = recording.metadata.encoder_resolution or find_position_step(position)
    if step is not None and travel < _FEW_STEPS * step:
        message = f"the joint moves by {travel / step:.0f} encoder steps in all: sliding friction cannot be seen"
        return (Finding("no_sliding", "warning", message, "record a larger motion", column="position"),)
    moving = _moving(recording, travel)
    if not moving.any():
        return ()
    if 1 - moving.mean() > _REST_PART:
        message = f"the joint rests for {100 * (1 - moving.mean()):.0f} % of the {recording.duration:.4g} s"
        advice = "cut the rests, or weigh them knowingly"
        return (Finding("rest", "note", message, advice, column="position"),)
    return ()


def find_stuck(recording: Recording) -> tuple[Finding, ...]:
    """A channel that keeps one value, bit for bit, while the joint goes on moving."""
    found = []
    for name, runs in _stuck_channels(recording).items():
        if runs:
            found.append(_describe_stuck(recording, name, *runs[0]))
    return tuple(found)


def find_stuck_rows(recording: Recording) -> NDArray[np.bool_]:
    """Rows in which position or torque is stuck or at its limit while the joint goes on moving. Shape (n_samples,)."""
    rows = np.zeros(len(recording), dtype=bool)
    for name, runs in _stuck_channels(recording).items():
        if name in ("position", "torque"):
            for start, stop in runs:
                rows[start : stop + 1] = True
    return rows


def find_idle_rows(recording: Recording) -> NDArray[np.bool_]:
    """Rows of long stretches in which the torque is exactly zero while the joint moves: its drive is off then.

    Another motor or a hand moves the joint, and what friction takes is not in the torque. Shape (n_samples,).
    """
    rows = np.zeros(len(recording), dtype=bool)
    if recording.metadata.torque_kind == "commanded":
        return rows
    for start, stop in _stuck_channels(recording).get("torque", []):
        if recording.torque[start] == 0.0 and recording.time[stop] - recording.time[start] > _IDLE_TIME:
            rows[start : stop + 1] = True
    return rows if np.count_nonzero(~rows) > _STUCK_ROWS else np.zeros(len(recording), dtype=bool)


def _stuck_channels(recording: Recording) -> dict[str, list[tuple[int, int]]]:
    """First and last rows of each stretch in which a channel is stuck, by channel."""
    travel = float(np.ptp(recording.position))
    if travel < _FEW_STEPS * (recording.metadata.encoder_resolution or 0.0) or travel == 0:
        return {}
    measured = ["velocity", "acceleration", "current", "load_torque"]
    measured += [] if recording.metadata.torque_kind == "commanded" else ["torque"]
    runs = {name: _find_stuck(recording, name, recording.position, travel) for name in measured}
    return runs | {"position": _find_stuck(recording, "position", _claimed_motion(recording), travel)}


def find_wraps(recording: Recording) -> tuple[Finding, ...]:
    """Jumps of position: by a turn, by the whole range of a counter, or by anything else."""
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
    standing = _find_placeholder(recording.position, float(size[wraps[0]])) if wraps.size else None
    if standing is not None:
        rows = np.flatnonzero(recording.position == standing)
        message = f"position is {standing:.6g} in {rows.size} row(s), far from all others: it stands for no value"
        advice = "leave these rows out; identify and diagnose do so by themselves"
        return (Finding("spike", "warning", message, advice, int(rows[0]) + 1, "position"),)
    if wraps.size:
        row = int(wraps[0])
        what = "2π" if near_turn[row] else "its whole range"
        message = f"position jumps by {step[row]:.5g}, {what}, {wraps.size} time(s): it wraps round"
        passed = float(np.median(size[max(row - 2, 0) : row + 3]))  # the way of the joint itself within the step
        period = snap_period(float(size[row]) + passed, measure_quantum(np.asarray(recording.position)))
        if recording.metadata.motion == "rotary" and period == TURN_IN_DEGREES:
            message = f"position wraps round at 360, {wraps.size} time(s): factor 57.3, it is in degrees"
            advice = 'multiply by π/180 and unwrap it (unit = "deg", unwrap = 6.28319 in a mapping)'
            return (Finding("degrees", "error", message, advice, row + 2, "position"),)
        if recording.metadata.motion == "rotary" and period == ONE_TURN:
            message = f"position wraps round at 1, {wraps.size} time(s): factor 6.28, it is in turns"
            advice = 'multiply by 2π and unwrap it (unit = "turns", unwrap = 6.28319 in a mapping)'
            return (Finding("turns", "error", message, advice, row + 2, "position"),)
        advice = f"unwrap it (unwrap = {period:.6g} in a mapping)"
        return (Finding("wrap", "error", message, advice, row + 2, "position"),)
    rate = size / np.maximum(np.diff(recording.time) / recording.sample_period, 1.0)  # a gap in time is no jump
    jumps = np.flatnonzero((rate > _JUMP_FACTOR * usual) & (size > 0.01 * travel))
    if not jumps.size:
        return ()
    row = int(jumps[0])
    if row in find_new_zeros(recording):
        message = f"the zero of position is set anew: it jumps by {step[row]:.5g} {recording.metadata.position_unit}"
        advice = "identify and diagnose move what is before it"
        return (Finding("jump", "warning", f"{message} and the joint goes on as before", advice, row + 2, "position"),)
    message = f"position jumps by {step[row]:.5g} {recording.metadata.position_unit} where {usual[row]:.2g} is usual"
    return (Finding("jump", "warning", message, "look for lost samples; split there", row + 2, "position"),)


def _find_lone(position: Samples) -> NDArray[np.bool_]:
    """Rows outside the range of all others, to which the position leaps and from which it comes straight back.

    A counter that wraps stays within its range, and one value that stands for none is told as such. Shape (n_samples,).
    """
    lone = np.zeros(position.size, dtype=bool)
    if position.size < _FEW_STEPS:
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


def find_spikes(recording: Recording) -> tuple[Finding, ...]:
    """Single samples far from both neighbours."""
    found = []
    for name in ("position", "velocity", "torque", "current"):
        values = recording.channels.get(name)
        if values is None or values.size < 50 or (name == "current" and np.array_equal(values, recording.torque)):
            continue
        middle = np.median(np.stack([values[:-2], values[1:-1], values[2:]]), axis=0)
        excess = np.abs(values[1:-1] - middle)
        if not excess.any():
            continue
        limit = max(_SPIKE_FACTOR * float(np.percentile(excess[excess > 0], 75)), 0.2 * float(np.ptp(middle)))
        spikes = np.flatnonzero(excess > limit)
        if spikes.size:
            row = int(spikes[0]) + 1
            message = f"{spikes.size} single sample(s) far from their neighbours, the first {values[row]:.5g}"
            advice = _SPIKES_ARE.get(name, "remove these rows")
            found.append(Finding("spike", "warning", message, advice, row + 1, name))
    return tuple(found)


def _around(size: Samples) -> Samples:
    """Median of the two steps before and the two after each step; a fast part is no jump in a slow recording."""
    padded = np.pad(size, 2, mode="edge")
    shifts = [padded[k : k + size.size] for k in (0, 1, 3, 4)]
    return np.asarray(np.median(np.stack(shifts), axis=0), dtype=np.float64)


def _moving(recording: Recording, travel: float) -> NDArray[np.bool_]:
    """Blocks of 0.25 s, or of five samples, in which the joint moves by more than 1e-4 of its travel.

    It is looked at four times in a block: a swing of a block's length ends where it began.
    """
    rows = max(5, round(0.25 / recording.sample_period))
    starts = np.arange(0, len(recording) - rows, rows)
    looks = [starts + round(0.25 * part * rows) for part in range(1, 5)]
    reach = np.max([np.abs(recording.position[look] - recording.position[starts]) for look in looks], axis=0)
    step = recording.metadata.encoder_resolution or 0.0
    return np.asarray(reach > max(1e-4 * travel, 1.5 * step))


def _claimed_motion(recording: Recording) -> Samples | None:
    """Motion as another channel than position tells it [as position].

    A velocity counts as far as it is beyond what it reads at rest: a register has counts and a code may have no zero.
    """
    if recording.velocity is None:
        return recording.position_reference
    at_rest = read_at_rest(recording)
    velocity = recording.velocity - at_rest.bias
    velocity = np.where(np.abs(velocity) > at_rest.width, velocity, 0.0)
    step = np.minimum(np.diff(recording.time), GAP_PERIODS * recording.sample_period)  # nothing is claimed over gaps
    return np.concatenate([[0.0], np.cumsum(velocity[:-1] * step)])


def _find_stuck(recording: Recording, name: str, motion: Samples | None, travel: float) -> list[tuple[int, int]]:
    """First and last rows of each stretch in which a channel is stuck though it could have shown the motion."""
    values = recording.channels.get(name)
    if values is None or motion is None:
        return []
    coarse = name != "position" and measure_quantum(values) > _STUCK_SHARE * float(np.std(values))
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values) != 0) + 1])
    stops = np.concatenate([starts[1:], [values.size]]) - 1
    duration = recording.time[stops] - recording.time[starts]
    found = []
    for run in np.flatnonzero((duration >= _STUCK_TIME) & (stops - starts >= _STUCK_ROWS)):
        start, stop = int(starts[run]), int(stops[run])
        moved = float(np.ptp(motion[start : stop + 1]))
        explained = abs(values[start]) * duration[run] if name == "velocity" else 0.0
        usual = _usual_lag(recording, start, stop) if motion is recording.position_reference else 0.0
        extreme = abs(values[start]) == np.abs(values).max() > 0
        if coarse and not (extreme and name == "torque"):
            continue
        if moved > max(_STUCK_TRAVEL * travel, _BEYOND_LAG * usual) and abs(moved - explained) > 0.25 * moved:
            found.append((start, stop))
    return found


def _usual_lag(recording: Recording, start: int, stop: int) -> float:
    """How far the joint lags behind its reference elsewhere: a soft loop stays that long in stiction [as position]."""
    assert recording.position_reference is not None
    lag = np.delete(np.abs(recording.position_reference - recording.position), slice(start, stop + 1))
    return float(np.quantile(lag, 0.95)) if lag.size else 0.0


def _describe_stuck(recording: Recording, name: str, start: int, stop: int) -> Finding:
    values = recording.channels[name]
    duration = recording.time[stop] - recording.time[start]
    message = f"{name} stays at {values[start]:.5g} for {duration:.3g} s"
    if name == "position":
        teller = "velocity" if recording.velocity is not None else "position_reference"
        message += f" while {teller} says that the joint moves"
        return Finding("stuck", "warning", message, "one of the two is wrong: check both", start + 1, name)
    message += " while the joint moves"
    if abs(values[start]) == np.abs(values).max() > 0:
        return Finding("saturated", "warning", message, "it may be at its limit: drive less", start + 1, name)
    return Finding("stuck", "warning", message, "check the sensor or leave these rows out", start + 1, name)
