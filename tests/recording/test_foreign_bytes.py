"""Whatever bytes a file holds, reading gives a recording or one `RecordingError`."""

import warnings
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fricomp.errors import RecordingError
from fricomp.recording import (
    Recording,
    RecordingWarning,
    RecordingWriter,
    check_recording,
    convert,
    load_mapping,
    read_blocks,
    read_recording,
)

_VALID = (
    b'# fricomp.recording/1\n# joint: "a"\ntime,position,torque\n0.0,1.0,2.0\n0.1,1.5,2.0\n'
    b'# block: {"label":"a","rows":2}\n'
)
_NOISE = st.binary(max_size=60)
_CELLS = st.sampled_from(["1", "-2.5", "1e308", "nan", "inf", "", "x", "0x1", "1_0", "#", "\x00", "9" * 400, "é"])
_LINES = st.lists(st.lists(_CELLS, max_size=4).map(",".join), max_size=6).map("\n".join)
_SETTINGS = settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def _read(path: Path) -> None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RecordingWarning)
            recording = read_recording(path)
    except RecordingError:
        return
    assert isinstance(recording, Recording)
    check_recording(recording)


@_SETTINGS
@given(st.one_of(_NOISE, _LINES.map(lambda lines: ("time,position,torque\n" + lines).encode())))
def test_foreign_content(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "any.csv"
    path.write_bytes(content)
    _read(path)


@_SETTINGS
@given(st.integers(0, len(_VALID)), st.integers(0, 30), _NOISE)
def test_damaged_recordings(tmp_path: Path, start: int, length: int, noise: bytes) -> None:
    path = tmp_path / "damaged.csv"
    path.write_bytes(_VALID[:start] + noise + _VALID[start + length :])
    _read(path)
    try:
        read_blocks(path)
        RecordingWriter(path, resume=True).close()
    except RecordingError:
        pass


@_SETTINGS
@given(st.sampled_from(["bam-xl330/2026-01-15_10h28m10.json", "ur10e/ur-20_01_22-joint_1.csv"]), _NOISE)
def test_foreign_sources(tmp_path: Path, name: str, content: bytes) -> None:
    _refuse(tmp_path, name, content)


@settings(_SETTINGS, max_examples=6)  # each is read in a process of its own; `test_hostile_files` damages more of them
@given(_NOISE)
def test_noise_is_no_matlab_file(tmp_path: Path, content: bytes) -> None:
    _refuse(tmp_path, "emps/DATA_EMPS.mat", content)


def _refuse(place: Path, name: str, content: bytes) -> None:
    folder, file = name.split("/")
    (place / file).write_bytes(content)
    with pytest.raises(RecordingError):
        convert(place / file, load_mapping(folder))
