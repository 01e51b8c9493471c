"""What every recording must satisfy: equal lengths, finite samples of some size, time that moves forward."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.finding import Finding, Severity
from fricomp.recording.stamps import find_rising, find_row_rate

Samples = NDArray[np.float64]

LARGEST = 1e60
"""No sensor reads as much in any unit, and the powers of it that checks take are finite."""

_MANY, _TOO_MANY = 0.01, 0.2  # parts of the rows that were left out
_JITTER = 10.0  # periods by which a stamp may lie before an earlier one: computers are late at times
_MANY_STAMPED_BACK = 0.5  # part of the rows of a clock that jitters which may have no later stamp than one before
_LONGER_BESIDE = 2.5  # usual steps over a repeated stamp and those beside it: 3, or 2 where a row came between
_SHORTEST_PERIOD = 1e-9  # [s]: stamps of the finest clocks differ by as much
_MANY_REPEATED = 0.2  # part of the rows with the stamp of the one before, above which the clock is coarse


def find_invalid(channels: Mapping[str, Samples]) -> tuple[Finding, ...]:
    """Return the errors that forbid using these channels, in the order of the columns.

    Args:
        channels: Channel name to samples [SI]; `time` [s] among them. Shape (n_samples,) each.
    """
    shapes = _find_shape_errors(channels)
    if shapes:
        return shapes
    not_finite = tuple(
        finding for name, values in channels.items() if (finding := _find_not_finite(name, values)) is not None
    )
    return not_finite or _find_backward_time(channels["time"]) or _find_standing_time(channels["time"])


def find_usable_rows(channels: Mapping[str, Samples]) -> NDArray[np.bool_]:
    """Return the rows whose samples are all finite, and no larger than any reading, and whose time goes on.

    Stamps far from all others, or out of order, cost their own rows alone.

    Args:
        channels: As for `find_invalid`, of equal lengths.

    Returns:
        Shape (n_samples,).
    """
    keep = np.ones(channels["time"].size, dtype=bool)
    for values in channels.values():
        if not _are_readings(values):
            keep &= find_readings(values)
    keep[keep] = find_rising(channels["time"] if keep.all() else channels["time"][keep])
    return keep


def drop_bad_rows(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """Return the usable rows of all channels, and a finding on how many were left out.

    Args:
        channels: As for `find_invalid`, of equal lengths.
    """
    keep = find_usable_rows(channels)
    if keep.all():
        return dict(channels), ()
    return {name: values[keep] for name, values in channels.items()}, tell_bad_rows(keep, channels)


def mend_stamps(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """Return the channels with stamps that rise, where little is wrong with them, and a note on what was done.

    Of rows that are stamped alike the first is kept. Many of them are a coarse clock, whose rows have instants of their
    own: they stay, and are refused later with what to write. Where some rows are stamped as or a little before those
    that they follow, and the steps beside them are longer for it, the clock jitters: all rows stay, and those get
    stamps just after (`mend_clock` then makes them even).

    Args:
        channels: As for `find_invalid`; `time` may be missing.
    """
    time = channels.get("time", np.zeros(0))
    same = {values.shape for values in channels.values()} == {time.shape} and time.ndim == 1
    step = np.diff(time) if same and time.size > 2 else np.ones(0)
    repeated = np.concatenate([[False], step == 0.0]) if step.size else np.zeros(0, dtype=bool)
    if _jitters(time, step):
        message = f"{np.count_nonzero(step <= 0.0)} of {time.size} rows are stamped no later than the one before"
        finding = Finding("jitter", "note", f"{message}, as by a clock that jitters", "nothing to do", column="time")
        return {**channels, "time": _raise_stamps(np.sort(time), float(np.median(step)))}, (finding,)
    if not repeated.any() or np.mean(repeated) > _MANY_REPEATED:
        return dict(channels), ()
    row = int(np.argmax(repeated)) + 1
    message = f"{np.count_nonzero(repeated)} of {time.size} rows are stamped as the one before and were left out"
    return {name: values[~repeated] for name, values in channels.items()}, (
        Finding("repeated_rows", "note", message, "nothing to do", row, "time"),
    )


def _jitters(time: Samples, step: Samples) -> bool:
    """Whether some rows are stamped no later than those that they follow, by less than a few periods, and few are.

    A row that came in between shortens no other step; one that is stamped early or late lengthens those beside it.
    """
    if not np.any(step <= 0.0) or not np.isfinite(time).all():
        return False
    back = np.maximum.accumulate(time)[:-1] - time[1:]
    usual = float(np.median(step))
    if float(np.mean(back >= 0.0)) > _MANY_STAMPED_BACK or float(back.max()) >= _JITTER * usual:
        return False
    within = np.flatnonzero(step[1:-1] <= 0.0) + 1
    beside = step[within - 1] + step[within] + step[within + 1]
    return bool(np.any(step < 0.0) or (within.size > 0 and float(np.mean(beside)) > _LONGER_BESIDE * usual))


def _raise_stamps(time: Samples, period: float) -> Samples:
    """Stamps that rise: what is no later than a stamp before it comes a millionth of a period after that."""
    least = 1e-6 * period * np.arange(time.size)
    return np.asarray(np.maximum.accumulate(time - least) + least)


def drop_twins(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """Return the channels without rows that are the one before once more, stamp and all, and a note on them.

    Args:
        channels: As for `find_invalid`, of equal lengths.
    """
    rows = np.flatnonzero(np.diff(channels["time"]) == 0.0)
    for values in channels.values():
        rows = rows[values[rows] == values[rows + 1]]
    if not rows.size:
        return dict(channels), ()
    twins = np.zeros(channels["time"].size, dtype=bool)
    twins[rows + 1] = True
    message = f"{np.count_nonzero(twins)} of {twins.size} rows are the one before once more and were left out"
    found = Finding("repeated_rows", "note", message, "nothing to do", int(np.argmax(twins)) + 1, "time")
    return {name: values[~twins] for name, values in channels.items()}, (found,)


def tell_bad_rows(keep: NDArray[np.bool_], channels: Mapping[str, Samples]) -> tuple[Finding, ...]:
    """How many rows were left out, and why; the more, the graver.

    Args:
        keep: Rows that stay. Shape (n_samples,).
        channels: All rows, as for `find_invalid`.
    """
    bad = np.flatnonzero(~keep)
    if not bad.size:
        return ()
    share = bad.size / keep.size
    severity: Severity = "error" if share > _TOO_MANY else "warning" if share > _MANY else "note"
    why, advice = _explain_bad_rows(keep, channels)
    if severity == "note":
        advice = "nothing to do: they are few"
    return (
        Finding("bad_rows", severity, f"{bad.size} of {keep.size} rows were left out: {why}", advice, int(bad[0]) + 1),
    )


def _explain_bad_rows(keep: NDArray[np.bool_], channels: Mapping[str, Samples]) -> tuple[str, str]:
    """What most of the rows that do not stay lack, and what to do."""
    empty = {name: int(np.count_nonzero(~find_readings(values))) for name, values in channels.items()}
    most = max(empty, key=lambda name: empty[name])
    if 2 * empty[most] >= np.count_nonzero(~keep):
        return (
            f"no finite number in every column, or no later time; {most} has no number in {empty[most]} of them",
            f"look at what the source holds there, or leave the column of {most} out where it is not needed",
        )
    time = channels["time"]
    repeated = np.count_nonzero(np.diff(time) == 0.0)
    rate = find_row_rate(time[np.isfinite(time)])
    if repeated <= _MANY_REPEATED * time.size:
        why = "no finite number in every column, or no later time" if any(empty.values()) else "no later time"
        return why, "look at what the source holds there"
    return f"{repeated} are stamped as the one before, by a clock that is coarser than they are", _advise_rate(rate)


def _advise_rate(rate: float | None) -> str:
    """What to write where several rows share each stamp and come at this rate [Hz], or at one that does not show."""
    if rate is None:
        return (
            "give the rate of the rows, which the stamps do not tell: fricomp convert LOG --row-rate RATE --out "
            "joint.csv; seconds since 1970 need numbers of double precision"
        )
    return (
        f"give the rate of the rows, which is some {rate:.5g} Hz: fricomp convert LOG --row-rate {rate:.5g} --out "
        f"joint.csv, or time = {{ rate = {rate:.5g} }} in a mapping"
    )


def _find_shape_errors(channels: Mapping[str, Samples]) -> tuple[Finding, ...]:
    rows = channels["time"].shape
    if len(rows) != 1 or rows[0] < 2:
        message = f"time has shape {rows}, a recording needs one column of at least 2 samples"
        return (Finding("length", "error", message, "record longer or check the file", column="time"),)
    return tuple(
        Finding(
            "length",
            "error",
            f"{name} has shape {values.shape} where time has {rows}",
            "give every channel one sample for each time",
            column=name,
        )
        for name, values in channels.items()
        if values.shape != rows
    )


def find_readings(values: Samples) -> NDArray[np.bool_]:
    """Which samples a sensor may have read. Shape (n_samples,)."""
    return np.abs(values) < LARGEST


def _are_readings(values: Samples) -> bool:
    """Whether a sensor may have read all samples: by the outermost ones, without an array of as many. Shape (n,)."""
    return bool(values.size == 0 or (values.max() < LARGEST and values.min() > -LARGEST))


def _find_not_finite(name: str, values: Samples) -> Finding | None:
    if _are_readings(values):
        return None
    bad = np.flatnonzero(~find_readings(values))
    if not bad.size:
        return None
    if bad.size == values.size:
        advice = "leave the column out" if name not in {"time", "position", "torque"} else "record it, it is required"
    else:
        advice = "remove these rows (fricomp convert --skip-bad-rows) or leave the column out"
    what = "larger than any reading" if np.isfinite(values[bad[0]]) else "not a finite number"
    message = f"{values[bad[0]]} is {what} ({bad.size} of {values.size} rows)"
    return Finding("not_finite", "error", message, advice, int(bad[0]) + 1, name)


def _find_backward_time(time: Samples) -> tuple[Finding, ...]:
    step = np.diff(time)
    bad = np.flatnonzero(step <= 0)
    if not bad.size:
        return ()
    row = int(bad[0]) + 1
    if step[row - 1] == 0:
        message = f"time {time[row]:.6g} s is stamped twice ({bad.size} rows do not advance)"
        advice = "remove the repeated rows (fricomp convert --skip-bad-rows keeps the first of each), "
        advice += "or write spread = true for time in a mapping, where the rows were taken evenly"
        if bad.size > _MANY_REPEATED * time.size:
            advice = _advise_rate(find_row_rate(time))
        return (Finding("repeated_time", "error", message, advice, row + 1, "time"),)
    message = f"time falls from {time[row - 1]:.6g} s to {time[row]:.6g} s ({bad.size} rows do not advance)"
    advice = "split the file there or restore the clock: time must rise from row to row"
    return (Finding("backward_time", "error", message, advice, row + 1, "time"),)


def _find_standing_time(time: Samples) -> tuple[Finding, ...]:
    """Find a time that rises by less than any clock counts, as one in another unit does."""
    period = float(np.median(np.diff(time), overwrite_input=True)) if time.size > 1 else np.inf
    if period >= _SHORTEST_PERIOD:
        return ()
    message = f"time goes on by {period:.3g} s from row to row"
    return (Finding("standing_time", "error", message, "write the unit of time in a mapping", column="time"),)
