"""Folders with a file for each quantity, all joints in it: `q.txt` and `tau.txt`, `positions.csv` and `torques.csv`."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.sources import is_text
from fricomp.recording.validity import Samples

from .choice import TORQUES
from .column import read_column_name
from .source import is_bag_folder, read_named_columns
from .times.clock import find_stamps

_TIME_FILE = re.compile(r"(^|[_\W])(t|time|times|stamps?|timestamps?)$", re.IGNORECASE)


def is_log_folder(path: Path) -> bool:
    """Whether a path is a folder that is one log: a bag, or a file for each quantity."""
    return is_bag_folder(path) or is_quantity_folder(path)


def is_quantity_folder(path: Path) -> bool:
    """Whether a path is a folder that is one log, with a file for each quantity."""
    if not path.is_dir() or is_bag_folder(path):
        return False
    said = {one.channel for file in _find_texts(path) if (one := read_column_name(file.stem)) is not None}
    return "position" in said and bool(said & set(TORQUES)) and bool(read_quantity_files(path))


def read_quantity_files(folder: Path) -> dict[str, Samples]:
    """Columns of a folder that holds one quantity a file, all joints in each: `q.txt`, `tau.txt`.

    A file of as many numbers as there are times, or a whole multiple, is read row by row; tables with a time in each
    have joints for names.

    Returns:
        Named `position:1` and so on, or `elbow.positions`, and `time`; empty where the folder is no such.
    """
    files = _find_texts(folder)
    times = [path for path in files if _TIME_FILE.search(path.stem)]
    meanings = {path: read_column_name(path.stem) for path in files if path not in times}
    if len(times) != 1 or not any(one is not None and one.channel == "position" for one in meanings.values()):
        return {} if times else _read_tables(folder)
    try:
        time = _load_numbers(times[0]).ravel()
        columns = {"time": time}
        for path, meaning in meanings.items():
            if meaning is None:
                continue
            values = _load_numbers(path)
            if values.size % time.size:
                raise RecordingError(f"{path} has {values.size} numbers, and {times[0].name} {time.size} times")
            for k, column in enumerate(values.reshape(time.size, -1).T, start=1):
                columns[f"{meaning.channel}:{k}"] = column
    except ValueError:
        return {}
    return columns


def _load_numbers(path: Path) -> Samples:
    with path.open(encoding="utf-8", errors="replace") as stream:
        mark = "," if "," in stream.readline() else None
    return np.asarray(np.loadtxt(path, delimiter=mark, dtype=np.float64))


def _read_tables(folder: Path) -> dict[str, Samples]:
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
    result = {clocks["position"][0]: times["position"]}
    if all(len(columns) == 1 for columns in read.values()):  # of one joint, whatever they are called
        for channel, columns in read.items():
            result[tables[channel].stem] = _take_at(times["position"], times[channel], *columns.values())
        return result
    joints = list(read["position"])
    if not joints or any(set(columns) != set(joints) for columns in read.values()):
        return {}
    for channel, columns in read.items():
        for joint in joints:
            name = f"{joint}.{tables[channel].stem}"
            result[name] = _take_at(times["position"], times[channel], columns[joint])
    return result


def _find_tables(folder: Path) -> Mapping[str, Path]:
    """The table of each quantity, by the channel that its name says; none where two are of one."""
    said = [
        (meaning.channel, path) for path in _find_texts(folder) if (meaning := read_column_name(path.stem)) is not None
    ]
    return dict(said) if len({channel for channel, _ in said}) == len(said) else {}


def _take_at(rows: Samples, time: Samples, values: Samples) -> Samples:
    return values if np.array_equal(rows, time) else np.asarray(np.interp(rows, time, values))


def _find_texts(folder: Path) -> list[Path]:
    return [path for path in sorted(folder.iterdir()) if path.is_file() and is_text(path)]
