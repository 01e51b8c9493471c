"""Recordings on disk: what is written reads back to the same bits, what is damaged is refused."""

import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording, RecordingMetadata, RecordingWarning, read_recording, write_recording
from fricomp.recording.file import read_content

MakeRecording = Callable[..., Recording]


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_written_recording_reads_back_to_the_same_bits(
    make_recording: MakeRecording, tmp_path: Path, suffix: str
) -> None:
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    recording = make_recording(500).with_metadata(
        gear_ratio=101.0, position_limits=(-1.0, 1.0), source="bench: # 3", extra={"payload": 2.5, "by": ["a", "b"]}
    )
    path = tmp_path / f"recording{suffix}"
    write_recording(recording, path)
    again = read_recording(path)
    assert again.content_hash == recording.content_hash
    assert again.metadata == recording.metadata
    assert list(tmp_path.iterdir()) == [path]


def test_plain_csv_of_a_spreadsheet_is_read(tmp_path: Path) -> None:
    path = tmp_path / "plain.csv"
    path.write_bytes("\ufeff# joint: wrist\n# bench: 7\ntorque, time,position\r\n1,0,2\r\n3,0.1,4".encode())
    recording = read_recording(path)
    assert recording.torque.tolist() == [1.0, 3.0]
    assert recording.metadata.joint == "wrist"
    assert recording.metadata.extra == {"bench": 7}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is empty: a recording starts with the header"),
        ("time,position,torque\n", "has a header and no rows"),
        ("time,position,torque\n0,1,2\n0.1,,2\n", "row 2, column position is empty"),
        ("time,position,torque\n0,1,2\n0.1,1,abc\n", "row 2, column torque holds 'abc'"),
        ("time,position,torque\n0,1,2\n0.1,1\n0.2,1,2\n", "row 2 has 2 cells where the header has 3"),
        ("time,position,torque\n0,1,2\n0.1,nan,2\n", "row 2, column position: nan"),
        (
            "time,position,wobble\n0,1,2\n1,1,2\n",
            "does not say where the torque .* are time, position, wobble",
        ),
        ("time,position\n0,1\n", "column 'torque' is missing"),
        ("# fricomp.recording/1\ntime,position,torque,torque\n0,1,2,2\n", "'torque' appears twice"),
        (
            "time,position,torque,torque\n0,1,2,3\n1,1,2,4\n",
            "2 columns are called 'torque'.* --channel 'torque=torque#2'",
        ),
        ("# fricomp.recording/9\ntime,position,torque\n0,1,2\n", "schema fricomp.recording/9.*update fricomp"),
        ("# motion: angular\ntime,position,torque\n0,1,2\n1,1,2\n", "valid are rotary, linear"),
        ("# extra: 5\ntime,position,torque\n0,1,2\n1,1,2\n", "extra is 5: give an object"),
        ("# gear_ratio: many\ntime,position,torque\n0,1,2\n1,1,2\n", "gear_ratio"),
    ],
)
def test_damaged_csv_is_refused_with_place_and_advice(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "damaged.csv"
    path.write_text(content)
    with pytest.raises(RecordingError, match=message) as raised:
        read_recording(path)
    assert str(path) in str(raised.value)


def test_missing_file_folder_and_foreign_suffix_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no recording at"):
        read_recording(tmp_path / "absent.csv")
    with pytest.raises(RecordingError, match="is a folder"):
        read_recording(tmp_path)
    (tmp_path / "data.mat").write_bytes(b"MATLAB")
    with pytest.raises(RecordingError, match="is no MATLAB file"):
        read_recording(tmp_path / "data.mat")
    (tmp_path / "data.xyz").write_text("time,position,torque")
    with pytest.raises(RecordingError, match="unknown suffix"):
        read_recording(tmp_path / "data.xyz")
    (tmp_path / "binary.csv").write_bytes(bytes(range(128, 256)))
    with pytest.raises(RecordingError, match="no text file"):
        read_recording(tmp_path / "binary.csv")


def test_damaged_parquet_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    path = tmp_path / "damaged.parquet"
    path.write_bytes(b"PAR1 and then nothing")
    with pytest.raises(RecordingError, match="no Parquet file"):
        read_recording(path)


def test_a_folder_is_made_and_one_that_cannot_be_is_one_clear_error(
    make_recording: MakeRecording, tmp_path: Path
) -> None:
    path = tmp_path / "absent" / "recording.csv"
    write_recording(make_recording(10), path)
    with pytest.raises(RecordingError, match=f"cannot make the folder {path}"):
        write_recording(make_recording(10), path / "recording.csv")


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_full_disk_leaves_the_old_file_and_nothing_half_written(
    make_recording: MakeRecording, tmp_path: Path, suffix: str
) -> None:
    resource = pytest.importorskip("resource")
    path = tmp_path / f"recording{suffix}"
    write_recording(make_recording(100), path)
    old_limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    old_handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, old_limit[1]))
        with pytest.raises(RecordingError, match="cannot write"):
            write_recording(make_recording(20_000), path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old_limit)
        signal.signal(signal.SIGXFSZ, old_handler)
    assert list(tmp_path.iterdir()) == [path]
    assert len(read_recording(path)) == 100


def test_line_torn_by_a_kill_is_dropped_and_said(make_recording: MakeRecording, tmp_path: Path) -> None:
    path = tmp_path / "recording.csv"
    write_recording(make_recording(100), path)
    path.write_bytes(path.read_bytes()[:-4])  # every cell still there, the last one shortened
    with pytest.warns(RecordingWarning, match=r"row 100: the last line .* is unfinished"):
        recording = read_recording(path)
    assert len(recording) == 99
    assert recording.torque.tolist() == make_recording(100).torque[:99].tolist()


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_bad_rows_are_left_out_and_counted_where_that_is_asked_for(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"recording{suffix}"
    rows = [(0.0, 0.1, 1.0), (0.1, 0.2, float("nan")), (0.1, 0.3, 1.0), (0.1, 0.4, 1.0), (0.2, 0.5, 1.0)]
    if suffix == ".csv":
        path.write_text("time,position,torque\n" + "".join(f"{t},{q},{tau}\n" for t, q, tau in rows))
    else:
        pyarrow = pytest.importorskip("pyarrow")
        table = pyarrow.table(dict(zip(("time", "position", "torque"), zip(*rows, strict=True), strict=True)))
        pytest.importorskip("pyarrow.parquet").write_table(table, path)
    with pytest.raises(RecordingError, match="--skip-bad-rows"):
        read_content(path)
    recording, findings = read_content(path, skip_bad_rows=True)
    assert recording.position.tolist() == [0.1, 0.3, 0.5]  # of two rows with one time the first stays
    assert [finding.code for finding in findings] == ["bad_rows"]
    assert "2 of 5 rows" in findings[0].message


def test_rows_that_are_no_numbers_or_cut_short_are_bad_rows_too(tmp_path: Path) -> None:
    path = tmp_path / "recording.csv"
    path.write_text("time,position,torque\n0,0.1,1\n0.1,0.2,off\n0.2,0.3\n0.3,,1\n0.4,0.5,1\n")
    recording, findings = read_content(path, skip_bad_rows=True)
    assert recording.time.tolist() == [0.0, 0.4]
    assert "3 of 5 rows" in findings[0].message


def test_a_document_of_this_package_is_refused_by_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "friction.json"
    path.write_text('{"schema": "fricomp.model/1", "joint": "elbow", "law": [{"term": "viscous"}]}')
    with pytest.raises(RecordingError, match="is a model that fricomp wrote, and no recording"):
        read_recording(path)


def test_a_recording_of_no_named_joint_is_called_as_asked_and_one_of_another_is_refused(tmp_path: Path) -> None:
    time = np.arange(60) * 0.01
    channels = {"time": time, "position": np.sin(time), "torque": np.cos(time)}
    for name, metadata in (("bare", RecordingMetadata()), ("elbow", RecordingMetadata(joint="elbow"))):
        write_recording(Recording.from_channels(channels, metadata), tmp_path / f"{name}.csv")
    assert read_recording(tmp_path / "bare.csv", joint="wrist").metadata.joint == "wrist"
    assert read_recording(tmp_path / "elbow.csv", joint="elbow_joint").metadata.joint == "elbow_joint"
    with pytest.raises(RecordingError, match="recording of joint 'elbow', not of 'wrist'"):
        read_recording(tmp_path / "elbow.csv", joint="wrist")
