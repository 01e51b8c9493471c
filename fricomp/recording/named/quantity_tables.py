"""Folders with a table for each quantity, whose columns are called as the joints: `positions.csv`, `torques.csv`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.recording.sources import is_text
from fricomp.recording.validity import Samples

from .choice import TORQUES
from .clock import find_stamps
from .column import read_column_name
from .source import read_named_columns


def read_quantity_tables(folder: Path) -> dict[str, Samples]:
    """Columns of a folder that holds one quantity a table, with a time in each and the same joints in all.

    Rows are those of the positions; where another table has other times, it is read between its rows.

    Returns:
        Named `elbow.positions` and so on, and the time of the positions; empty where the folder is no such.
    """
    tables = _find_tables(folder)
    if "position" not in tables or not any(channel in tables for channel in TORQUES):
        return {}
    read = {channel: dict(read_named_columns(path)) for channel, path in tables.items()}
    clocks = {channel: find_stamps(columns) for channel, columns in read.items()}
    if not all(len(names) == 1 for names in clocks.values()):
        return {}
    times = {channel: columns.pop(clocks[channel][0]) for channel, columns in read.items()}
    joints = list(read["position"])
    if not joints or any(set(columns) != set(joints) for columns in read.values()):
        return {}
    result = {clocks["position"][0]: times["position"]}
    for channel, columns in read.items():
        for joint in joints:
            name = f"{joint}.{tables[channel].stem}"
            result[name] = _take_at(times["position"], times[channel], columns[joint])
    return result


def _find_tables(folder: Path) -> Mapping[str, Path]:
    """The table of each quantity, by the channel that its name says; none where two are of one."""
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and is_text(path)]
    said = [(meaning.channel, path) for path in files if (meaning := read_column_name(path.stem)) is not None]
    return dict(said) if len({channel for channel, _ in said}) == len(said) else {}


def _take_at(rows: Samples, time: Samples, values: Samples) -> Samples:
    return values if np.array_equal(rows, time) else np.asarray(np.interp(rows, time, values))
