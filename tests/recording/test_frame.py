"""Recordings go to pandas and come back; units are kept, and never taken for others."""

from __future__ import annotations

import sys

import numpy as np
import pandas as pd
import pytest

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording import Recording, RecordingMetadata

METADATA = RecordingMetadata(joint="slide", motion="linear", gear_ratio=3.0, torque_side="motor", extra={"run": 7})


@pytest.fixture
def recording() -> Recording:
    time = np.linspace(0.0, 1.0, 11)
    channels = {"time": time, "position": time**2, "torque": np.cos(time), "velocity": 2.0 * time}
    return Recording.from_channels(channels, METADATA)


def test_a_recording_comes_back_from_pandas_as_it_went(recording: Recording) -> None:
    frame = recording.to_pandas()
    assert frame.index.name == "time"
    assert frame.attrs["units"] == {"time": "s", "position": "m", "torque": "N", "velocity": "m/s"}
    again = Recording.from_pandas(frame)
    assert again.content_hash == recording.content_hash
    assert again.metadata == recording.metadata


def test_columns_of_other_names_are_mapped_and_further_ones_left_out() -> None:
    frame = pd.DataFrame({"t": [0.0, 0.1], "q": [1.0, 2.0], "torque": [0.5, 0.6], "note": ["a", "b"]})
    found = Recording.from_pandas(frame, RecordingMetadata("elbow"), columns={"time": "t", "position": "q"})
    assert list(found.channels) == ["time", "position", "torque"]
    assert found.metadata.joint == "elbow"


@pytest.mark.parametrize(
    "index",
    [
        pd.to_timedelta([0.0, 0.1], unit="s"),
        pd.to_datetime(["2026-01-01T00:00:00.0", "2026-01-01T00:00:00.1"]),
        pd.Index([0.0, 0.1]),
    ],
)
def test_an_index_of_times_is_the_time(index: pd.Index) -> None:
    frame = pd.DataFrame({"position": [1.0, 2.0], "torque": [0.5, 0.6]}, index=index)
    assert Recording.from_pandas(frame).time == pytest.approx([0.0, 0.1])


def test_degrees_are_not_taken_for_radians() -> None:
    frame = pd.DataFrame({"time": [0.0, 0.1], "position": [10.0, 20.0], "torque": [0.5, 0.6]})
    frame.attrs["units"] = {"position": "deg"}
    with pytest.raises(RecordingError, match="'position' is in deg and position must be in rad"):
        Recording.from_pandas(frame)


def test_a_frame_without_time_or_with_a_column_missing_is_refused_with_what_to_do() -> None:
    frame = pd.DataFrame({"position": [10.0, 20.0], "torque": [0.5, 0.6]})
    with pytest.raises(RecordingError, match="give a column time"):
        Recording.from_pandas(frame)
    with pytest.raises(RecordingError, match="no column 'q' for position"):
        Recording.from_pandas(frame, columns={"position": "q"})
    with pytest.raises(RecordingError, match="'torque' is missing"):
        Recording.from_pandas(frame.drop(columns="torque").assign(time=[0.0, 0.1]))


def test_pandas_that_is_not_there_is_asked_for(recording: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingExtraError, match="pip install pandas"):
        recording.to_pandas()


@pytest.mark.parametrize("kind", ["datetime", "zone", "timedelta"])
def test_times_in_a_column_are_seconds_whatever_their_type(kind: str) -> None:
    seconds = np.arange(50) * 0.004
    time = {
        "datetime": pd.to_datetime(seconds + 1.7e9, unit="s"),
        "zone": pd.to_datetime(seconds + 1.7e9, unit="s", utc=True).tz_convert("Europe/Berlin"),
        "timedelta": pd.to_timedelta(seconds, unit="s"),
    }[kind]
    frame = pd.DataFrame({"time": time, "position": np.sin(seconds), "torque": np.cos(seconds)})
    assert Recording.from_pandas(frame).time == pytest.approx(seconds, abs=1e-6)


def test_what_is_no_data_frame_is_refused_by_its_type() -> None:
    with pytest.raises(RecordingError, match="ndarray is no data frame"):
        Recording.from_pandas(np.zeros((3, 3)))
