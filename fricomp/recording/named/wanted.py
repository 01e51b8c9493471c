"""The columns that a mapping asks for, as the source has them or as the inspection calls them."""

from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from fricomp.errors import FricompError, RecordingError
from fricomp.recording.mapping import Column, Source
from fricomp.recording.sources import Columns, read_columns
from fricomp.recording.validity import Samples

from .source import read_named_columns
from .sparse import join_sparse


def read_wanted(
    path: Path, source: Source, keys: Collection[Column], roles: Mapping[str, Column], *, skip_bad_rows: bool
) -> Columns:
    """The wanted columns: those of the source, or else as they are called where names alone are followed.

    Entries of lists beside their names, and rows of several signals or joints, are columns there: `elbow.position`;
    signals at several rates are placed there at common times. Channels that stand in rows of their own are placed at
    those of the position.

    Args:
        path: File or folder.
        source: How it is read.
        keys: Names or numbers of the columns.
        roles: The column of each channel, where all are of one joint; else empty.
        skip_bad_rows: Give NaN for what is no number, instead of an error.

    Raises:
        RecordingError: They cannot be read.
        MissingExtraError: The package that reads the format is not installed.
    """
    try:
        columns = read_columns(path, source, keys, skip_bad_rows=skip_bad_rows)
    except RecordingError:
        named = {} if source.topic else _read_named(path, keys)
        if named and all(np.all(np.isfinite(named[key])) for key in keys):
            return named
        joined = _join(named or _read_leniently(path, source, keys), roles)
        if not joined:
            raise  # the line that is wrong is told there
        return joined
    found = {key: key if key in columns else str(key).partition(" [")[0] for key in keys}
    if all(key in columns for key in found.values()) and len({columns[key].size for key in found.values()}) < 2:
        return _join(columns, roles) or columns
    return _read_named(path, keys) or columns


def _read_named(path: Path, keys: Collection[Column]) -> Columns:
    """The columns as the inspection calls them, where these are the ones that are wanted; else none."""
    with suppress(FricompError):  # whose message would be of what nobody has asked for
        named = read_named_columns(path)
        if all(key in named for key in keys):
            return dict(named.items())
    return {}


def _read_leniently(path: Path, source: Source, keys: Collection[Column]) -> Columns:
    with suppress(FricompError):
        return read_columns(path, source, keys, skip_bad_rows=True)
    return {}


def _join(columns: Columns, roles: Mapping[str, Column]) -> Columns:
    """The columns at the rows of the position, where the torque stands in rows of its own; empty where it does not."""
    table: dict[str, Samples] = {name: columns[key] for name, key in roles.items() if key in columns}
    if not {"time", "position", "torque"} <= table.keys() or len({values.size for values in table.values()}) > 1:
        return {}
    joined = join_sparse(table)
    if joined["time"].size == table["time"].size:
        return {}
    known = np.isfinite(np.sum(list(joined.values()), axis=0))
    return {roles[name]: values[known] for name, values in joined.items()}
