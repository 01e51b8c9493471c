"""Folders with a file for each quantity, all joints in it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.sources import is_text
from fricomp.recording.validity import Samples

from .column import read_column_name
from .quantity_tables import read_quantity_tables

_TIME_FILE = re.compile(r"(^|[_\W])(t|time|times|stamps?|timestamps?)$", re.IGNORECASE)


def read_quantity_files(folder: Path) -> dict[str, Samples]:
    """Columns of a folder that holds one quantity a file, all joints in each: `q.txt`, `tau.txt`.

    A file of as many numbers as there are times, or a whole multiple, is read row by row; tables with a time in each
    have joints for names.

    Returns:
        Named `position:1` and so on, or `elbow.positions`, and `time`; empty where the folder is no such.
    """
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and is_text(path)]
    times = [path for path in files if _TIME_FILE.search(path.stem)]
    meanings = {path: read_column_name(path.stem) for path in files if path not in times}
    if len(times) != 1 or not any(one is not None and one.channel == "position" for one in meanings.values()):
        return {} if times else read_quantity_tables(folder)
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
