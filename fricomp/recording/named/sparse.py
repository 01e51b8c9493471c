"""Rows that hold one channel each, as several topics in one table have them."""

import re
from collections.abc import Mapping

import numpy as np

from fricomp.recording.runs import find_covered, interpolate
from fricomp.recording.validity import Samples

_TOGETHER = 0.5
"""Part of the rarer channel's rows that have the position as well, from which on the rows are those of one table."""
_SERIES = re.compile(r"\.(?:data|values|signals\.values)$", re.IGNORECASE)
"""What the numbers of one signal are called, beside its time."""
_MOSTLY_SHARED = 0.9
"""Part of the time of signals from which on only their common time is kept: a short one must not cost the others."""
_FEWEST_CURVES = 2
"""Of a plot that are those of a joint: its position and its torque."""
_FEWEST = 50
"""Rows of a channel that are a log of it."""


def join_sparse(table: Mapping[str, Samples]) -> dict[str, Samples]:
    """The channels at the rows of the position, where the torque mostly stands in other rows; else as they are.

    Args:
        table: Channel to samples, NaN where a row has none; time, position and torque among them. Shape (n_rows,) each.
    """
    time, position, torque = (table[name] for name in ("time", "position", "torque"))
    placed, pushed = np.isfinite(time + position), np.isfinite(time + torque)
    fewest = min(np.count_nonzero(placed), np.count_nonzero(pushed))
    if fewest < _FEWEST or np.count_nonzero(placed & pushed) > _TOGETHER * fewest:
        return dict(table)
    order = np.argsort(time[placed], kind="stable")
    at = time[placed][order]
    return {
        name: at if name == "time" else values[placed][order] if name == "position" else _read_between(at, time, values)
        for name, values in table.items()
    }


def place_pairs(columns: dict[str, Samples]) -> dict[str, Samples]:
    """The columns at the first of their times, where each has its own beside it, as a scope with several rates writes.

    Args:
        columns: By name; the time of `torque` is `torque.time` where it is not the first column. Shape (n_rows,) each.
    """
    columns = _name_points(columns)
    stamps = {name: f"{name}.time" for name in columns if f"{name}.time" in columns}
    first = next(iter(columns), "")
    placed = {
        name: _read_between(columns[first], columns[stamp], columns[name])
        for name, stamp in stamps.items()
        if not np.array_equal(columns[stamp], columns[first], equal_nan=True)
    }
    return {name: placed.get(name, values) for name, values in columns.items() if name not in stamps.values()}


def _name_points(columns: dict[str, Samples]) -> dict[str, Samples]:
    """The columns of a plot, a pair of two names that differ in their last letter for each curve, `q.x` beside `q.y`,
    under the names of the curves and with the times of each beside it; others as they are.

    What is called `x` is a time where it rises with all others over the same span.
    """
    names = list(columns)
    pairs = list(zip(names[::2], names[1::2], strict=False))
    if len(pairs) < _FEWEST_CURVES or len(names) % 2 or any(a[:-1] != b[:-1] or a == b for a, b in pairs):
        return columns
    spans = [columns[stamp][np.isfinite(columns[stamp])] for stamp, _ in pairs]
    first, last = max(one[0] for one in spans if one.size), min(one[-1] for one in spans if one.size)
    longest = max(one[-1] - one[0] for one in spans if one.size)
    if not all(one.size and np.all(np.diff(one) >= 0.0) for one in spans) or last - first < _TOGETHER * longest:
        return columns
    named = dict[str, Samples]()
    for stamp, value in pairs:
        curve = value[:-1].rstrip("._ /")
        named |= {f"{curve}.time" if named else "time": columns[stamp], curve: columns[value]}
    return named


def place_series(columns: dict[str, Samples]) -> dict[str, Samples]:
    """The columns at the times of the longest, where each has its own beside it: `q.Time` and `q.Data` of a simulation
    that logs its signals at several rates.

    Args:
        columns: By name; of several lengths.
    """
    stamps = {name.rpartition(".")[0]: name for name in columns if name.rpartition(".")[2].lower() == "time"}
    owners = {
        name: stamps[signal]
        for name, values in columns.items()
        if (signal := _SERIES.sub("", name)) != name
        and signal in stamps
        and values.size == columns[stamps[signal]].size
    }
    sizes = {columns[stamp].size for stamp in owners.values()}
    if len(sizes) < 2:
        return columns
    longest = max(owners.values(), key=lambda stamp: columns[stamp].size)
    placed = {name: _read_between(columns[longest], columns[stamp], columns[name]) for name, stamp in owners.items()}
    placed[longest] = columns[longest]
    known = np.flatnonzero(np.isfinite(np.sum(list(placed.values()), axis=0)))
    is_shared = known.size > _MOSTLY_SHARED * columns[longest].size
    ends = slice(known[0], known[-1] + 1) if is_shared else slice(None)
    dropped = set(stamps.values()) - {longest}
    return {
        name: placed[name][ends] if name in placed else values
        for name, values in columns.items()
        if name not in dropped
    }


def _read_between(at: Samples, time: Samples, values: Samples) -> Samples:
    """A channel at other times, between its own readings; NaN in gaps and beyond the ends. Shape (n,)."""
    known = np.sort(time[np.isfinite(values + time)])
    return np.where(find_covered(known, at), interpolate(at, time, values), np.nan)
