"""Samples over time: runs whose clock starts again, one after the other, what lies between samples, and integrals."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.finding import Finding
from fricomp.recording.validity import Samples

_SHORTEST = 100
"""Rows of a run; shorter stretches between two falls of the clock are rows out of order."""
_RANGES = (
    *(86400.0, 43200.0, 3600.0, 60.0),
    *(2.0**bits * tick for tick in (1e-6, 1e-3, 1e-9) for bits in (32, 31, 24, 16)),
)
"""After how long times of day and counters of 16 to 32 bits begin anew [s]."""
_FEW = 5.0
"""Usual steps within which the first stamp after that follows the last one before."""
_LATE = 20.0
"""Usual steps by which a row may come after its turn; a clock that starts again falls by more."""
_BETWEEN = 1.0
"""Time that is put between two runs [s]: a gap, at which whatever reads the recording cuts it."""
_GAP = 5.0
"""Usual distances of two readings beyond which nothing is known between them."""


def sort_rows(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """The channels with their rows in the order of their stamps where the motion is smoother so, and a note.

    A network may deliver a row after its turn: then its stamp is right, and its place is not. Where a clock jitters it
    is the other way round, and sorted by their stamps the positions would go to and fro.

    Args:
        channels: As for `order_runs`.
    """
    time, moved = channels["time"], channels.get("position", channels.get("velocity"))
    step = np.diff(time)
    if moved is None or moved.size != time.size or not np.any(step < 0.0) or np.all(step <= 0.0):
        return dict(channels), ()  # rows that all run backwards are none that came late
    usual = float(np.median(np.abs(step)))
    order = np.argsort(time, kind="stable")
    paths = [float(np.sum(np.abs(np.diff(one)))) for one in (moved[order], moved)]
    if np.min(step) < -_LATE * usual or not paths[0] <= paths[1]:  # NaN is never less
        return dict(channels), ()
    count = int(np.count_nonzero(step < 0.0))
    message = f"{count} row(s) came after their turn, and were put in the order of their stamps"
    sorted_rows = {name: values[order] for name, values in channels.items()}
    return sorted_rows, (Finding("late_rows", "note", message, "nothing to do", column="time"),)


def order_runs(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """The channels with a time that goes on from run to run, and a note where it did not.

    Args:
        channels: Channel name to samples; `time` [s] among them. Shape (n_samples,) each.
    """
    time = channels["time"]
    step = np.diff(time)
    if time.size < 2 or not np.isfinite(time).all() or np.all(step >= 0.0):
        return dict(channels), ()
    if np.all(step <= 0.0):
        turned = {name: values[::-1] for name, values in channels.items()}
        return turned, (
            Finding("backward_time", "note", "the rows run backwards in time and were turned", "nothing to do"),
        )
    period = _find_period(step)
    if period:
        time = np.array(time)
        for row in np.flatnonzero(step < 0.0) + 1:
            time[row:] += period
        message = f"the clock begins anew after {period:.6g} s, as a counter that is full does: it was carried on"
        return {**channels, "time": time}, (Finding("runs", "note", message, "nothing to do", column="time"),)
    falls = np.flatnonzero(step < 0.0) + 1
    edges = np.concatenate([[0], falls, [time.size]])
    if np.min(np.diff(edges)) < _SHORTEST:
        return dict(channels), ()
    later = np.array(time)
    for a, b in pairwise(edges[1:].tolist()):
        later[a:b] += later[a - 1] + _BETWEEN - time[a]
    message = f"the clock starts again {falls.size} time(s): the runs were put one after the other, with a gap between"
    finding = Finding("runs", "note", message, "nothing to do", int(falls[0]) + 1, "time")
    return {**channels, "time": later}, (finding,)


def _find_period(step: Samples) -> float:
    """The range of a clock all of whose falls are such a range less a few steps [s]; 0 where there is none."""
    falls, usual = step[step < 0.0], float(np.median(step))
    ranges = [one for one in _RANGES if one > _LATE * usual]  # shorter falls are those of rows out of order
    return next((one for one in ranges if np.all((falls + one > 0.0) & (falls + one < _FEW * usual))), 0.0)


def integrate(values: Samples, time: Samples) -> Samples:
    """Integral of a channel over time, from zero, by trapezes. Shape (n_samples,)."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))])


def find_covered(time: Samples, instants: Samples) -> NDArray[np.bool_]:
    """Which instants lie between two of these times that are no gap apart. Shape (n_instants,).

    Args:
        time: Rising [s]. Shape (n_times,).
        instants: [s].
    """
    if time.size < 2:
        return np.zeros(instants.size, dtype=bool)
    steps = np.diff(time)
    place = np.clip(np.searchsorted(time, instants, side="right") - 1, 0, steps.size - 1)
    inside = (instants >= time[0]) & (instants <= time[-1])
    return np.asarray(inside & (steps[place] <= _GAP * float(np.median(steps))))


def interpolate(instants: Samples, time: Samples, values: Samples) -> Samples:
    """A channel at other times, on straight lines between the readings that are there; NaN where there are none.

    Args:
        instants: [s]. Shape (n_instants,).
        time: Of the readings, in any order [s]. Shape (n_times,).
        values: NaN where a row has none. Shape (n_times,).
    """
    known = np.flatnonzero(np.isfinite(values + time))
    if not known.size:
        return np.full(instants.size, np.nan)
    known = known[np.argsort(time[known], kind="stable")]
    return np.asarray(np.interp(instants, time[known], values[known]))
