"""Well-formed files whose columns are of kinds that their names do not promise."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import RecordingWarning, read_recording
from fricomp.recording.mapping import Source
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.sources import read_columns
from fricomp.recording.sources.protobuf_message import read_stamped_message

COUNTS = np.arange(300)


def _write(path: Path, time: Any) -> Path:
    import pyarrow
    from pyarrow import parquet

    wave = np.sin(0.05 * COUNTS)
    parquet.write_table(pyarrow.table({"time": time, "position": wave, "torque": wave}), path)
    return path


@pytest.mark.parametrize(
    ("kind", "factor"),
    [("timestamp[ns]", 10**7), ("timestamp[us]", 10**4), ("duration[ms]", 10), ("time64[ns]", 10**7)],
)
def test_dates_and_lengths_under_the_names_of_channels_are_times(kind: str, factor: int, tmp_path: Path) -> None:
    import pyarrow

    stamps = pyarrow.array(COUNTS * factor).cast(kind)
    with pytest.warns(RecordingWarning, match="'time' in"):
        recording = read_recording(_write(tmp_path / "log.parquet", stamps))
    assert recording.time == pytest.approx(0.01 * COUNTS, abs=1e-6)


@pytest.mark.parametrize("kind", ["string", "binary", "bool"])
def test_what_is_no_time_is_refused_in_words(kind: str, tmp_path: Path) -> None:
    import pyarrow

    words = pyarrow.array(["1", "0"] * 150).cast(kind)
    with pytest.raises(RecordingError, match=r"log\.parquet"):
        read_recording(_write(tmp_path / "log.parquet", words))


def test_a_column_of_days_hides_no_other(tmp_path: Path) -> None:
    import pyarrow

    _write(tmp_path / "log.parquet", pyarrow.array(COUNTS.astype(np.int32)).cast("date32[day]"))
    columns = read_named_columns(tmp_path / "log.parquet")
    assert set(columns) == {"time", "position", "torque"}
    assert np.diff(columns["time"]) == pytest.approx(86400.0)


def test_signals_of_simulink_without_a_label_have_their_number(tmp_path: Path) -> None:
    from scipy.io import savemat

    signals = [{"label": label, "values": COUNTS * 1.0} for label in ("q", "", "tau")]
    savemat(tmp_path / "log.mat", {"log": {"time": 0.01 * COUNTS, "signals": signals}})
    assert set(read_columns(tmp_path / "log.mat", Source(), [])) == {
        "log.time",
        "log.signals.q",
        "log.signals.2",
        "log.signals.tau",
    }


def test_objects_in_an_archive_are_called_so(tmp_path: Path) -> None:
    many = np.empty(1000, dtype=object)
    np.savez(tmp_path / "log.npz", q=many)
    with pytest.raises(RecordingError, match="holds objects of Python"):
        read_columns(tmp_path / "log.npz", Source(), [])


def test_a_message_with_several_headers_is_read() -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file: Any = descriptor_pb2.FileDescriptorProto(name="own.proto", package="own", syntax="proto3")
    message = file.message_type.add(name="Joint")
    message.field.add(name="name", number=1, label=1, type=9)
    message.field.add(name="position", number=2, label=1, type=1)
    message.field.add(name="header", number=3, label=3, type=11, type_name=".own.Joint")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    kind: Any = message_factory.GetMessageClass(pool.FindMessageTypeByName("own.Joint"))
    record = read_stamped_message(kind(position=1.0, header=[kind(name="a", position=2.0)]))
    assert record == {"position": 1.0, "header": {"a": {"position": 2.0, "header": {}}}}


@pytest.mark.parametrize("names", ["dt,q,tau", "time,q,tau", "sec,nanosec,q,tau"])
@pytest.mark.parametrize("rows", [0, 1])
def test_a_table_without_times_is_refused_in_words(names: str, rows: int, tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({name: np.zeros(rows) for name in names.split(",")}), tmp_path / "log.parquet")
    with pytest.raises(RecordingError, match="holds no times"):
        read_recording(tmp_path / "log.parquet")
