"""Recordings as data frames of pandas, and back; units and metadata are kept in `attrs`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.metadata import RecordingMetadata, channel_units, metadata_from_fields, metadata_to_fields

if TYPE_CHECKING:
    from pandas import DataFrame

    from fricomp.recording.validity import Samples

__all__ = ["read_frame", "write_frame"]

UNITS, METADATA = "units", "metadata"
"""Keys of `DataFrame.attrs`."""


def write_frame(channels: Mapping[str, Samples], metadata: RecordingMetadata) -> DataFrame:
    """A data frame with the time [s] as its index.

    Raises:
        MissingExtraError: pandas is not installed.
    """
    pandas = _pandas()
    columns = {name: values for name, values in channels.items() if name != "time"}
    frame = pandas.DataFrame(columns, index=pandas.Index(channels["time"], name="time"))
    units = channel_units(metadata)
    frame.attrs = {UNITS: {name: units[name] for name in channels}, METADATA: metadata_to_fields(metadata)}
    return frame


def read_frame(
    frame: DataFrame, metadata: RecordingMetadata | None, columns: dict[str, str]
) -> tuple[dict[str, Samples], RecordingMetadata]:
    """Channels and metadata of a data frame.

    Args:
        frame: Columns named as channels.
        metadata: None to take those of `attrs`.
        columns: Channel to the name of its column, where they differ.

    Raises:
        RecordingError: A column is missing, or its unit is another one than that of the recording.
        MissingExtraError: pandas is not installed.
    """
    pandas = _pandas()
    if not isinstance(frame, pandas.DataFrame):
        raise RecordingError(f"{type(frame).__name__} is no data frame: give one with time, position and torque")
    facts = metadata or metadata_from_fields(dict(frame.attrs.get(METADATA, {})))
    units = channel_units(facts)
    absent = [f"{column!r} for {name}" for name, column in columns.items() if column not in frame]
    if absent:
        raise RecordingError(f"the data frame has no column {absent[0]}: it has {', '.join(map(str, frame))}")
    names = {name: columns.get(name, name) for name in units}
    values = {name: frame[column].to_numpy() for name, column in names.items() if column in frame and name != "time"}
    _require_units(names, frame.attrs.get(UNITS, {}), units)
    time = _time_of(pandas.Index(frame[names["time"]], name="time") if names["time"] in frame else frame.index)
    return {"time": time, **values}, facts


def _require_units(names: Mapping[str, str], stated: Mapping[str, str], wanted: Mapping[str, str]) -> None:
    """Refuse a column whose stated unit is not that of its channel, rather than take degrees for radians."""
    for name, column in names.items():
        unit = stated.get(column, wanted[name])
        if unit != wanted[name]:
            raise RecordingError(
                f"column {column!r} is in {unit} and {name} must be in {wanted[name]}: convert it, and correct "
                "attrs['units']"
            )


def _time_of(index: Any) -> Any:
    """Time of the rows from the first one where it is dates or lengths of time, or as it is where it is numbers [s]."""
    if index.dtype.kind in "mM":
        return (index - index[0]).total_seconds().to_numpy() if len(index) else np.empty(0)
    if index.dtype.kind == "f" or index.name == "time":
        return index.to_numpy()
    raise RecordingError("the data frame has no time: give a column time [s], or an index of times")


def _pandas() -> Any:
    try:
        import pandas
    except ModuleNotFoundError as error:
        raise MissingExtraError("pandas") from error
    return pandas
