"""`fricomp convert`: writes what it read, says what it noticed, refuses what cannot be used."""

from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest

from fricomp.cli.convert import convert
from fricomp.errors import FricompError, OutputError, RecordingError
from fricomp.recording import intake, read_recording

from ..cli.called import call

MAPPING = """
[channels]
time = { column = "t" }
position = { column = "{joint}_q" }
torque = { column = "{joint}_tau" }
[[joints]]
name = "hip"
[[joints]]
name = "knee"
"""


def _convert(*arguments: object) -> CompletedProcess[str]:
    return call("convert", *arguments)


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """An archive of two joints and its mapping beside it."""
    (tmp_path / "robot.toml").write_text(MAPPING)
    time = np.arange(3000) / 500
    position = 0.5 * np.sin(4 * time)
    torque = np.sign(np.cos(4 * time))
    np.savez(tmp_path / "log.npz", t=time, hip_q=position, hip_tau=torque, knee_q=position, knee_tau=-torque)
    return tmp_path / "log.npz"


def test_one_joint_is_written_where_it_is_told(source: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = source.parent / "new" / "hip.csv"
    convert(source, out, str(source.with_name("robot.toml")), ["hip"], 250.0)
    assert "1500 samples" in capsys.readouterr().out
    recording = read_recording(out)
    assert recording.metadata.joint == "hip"
    assert recording.sample_period == pytest.approx(1 / 250)


def test_native_recordings_change_their_format_without_a_mapping(source: Path) -> None:
    pytest.importorskip("pyarrow")
    mapping = str(source.with_name("robot.toml"))
    convert(source, source.with_name("hip.csv"), mapping, ["hip"])
    convert(source.with_name("hip.csv"), source.with_name("hip.parquet"))
    first, second = (read_recording(source.with_name(name)) for name in ("hip.csv", "hip.parquet"))
    assert first.content_hash == second.content_hash


def test_a_joint_that_is_refused_costs_the_others_nothing(source: Path) -> None:
    arguments = (source, "--mapping", source.with_name("robot.toml"), "--out", source.with_name("leg.csv"))
    some = _convert(*arguments)
    assert some.returncode == 1
    assert "knee: not written: column torque" in some.stdout
    assert "flip its sign" in some.stdout
    assert [path.name for path in source.parent.glob("leg*")] == ["leg_hip.csv"]


def test_flipped_torque_is_status_2_without_force_and_nothing_is_written(source: Path) -> None:
    arguments = (source, "--mapping", source.with_name("robot.toml"), "--out", source.with_name("leg.csv"))
    refused = _convert(*arguments, "--only", "knee")
    assert refused.returncode == 2
    assert "knee: column torque" in refused.stderr
    assert "flip its sign" in refused.stderr
    assert "Traceback" not in refused.stderr
    assert not list(source.parent.glob("leg*"))
    forced = _convert(*arguments, "--force")
    assert forced.returncode == 0
    assert "error: column torque" in forced.stdout
    assert sorted(path.name for path in source.parent.glob("leg*")) == ["leg_hip.csv", "leg_knee.csv"]


@pytest.mark.parametrize(
    ("name", "out", "mapping", "only", "message"),
    [
        ("absent.npz", "a.csv", "robot.toml", [], "no source at"),
        ("log.npz", "a.csv", "robot.toml", ["wrist"], "valid are hip, knee"),
        ("log.npz", "a.xlsx", "robot.toml", ["hip"], "says no format"),
        ("log.npz", "a.csv", "nowhere", [], "no mapping 'nowhere'"),
        ("log.npz", "a.csv", "", ["knee"], "knee: column torque: torque against the motion"),
        ("log.npz", "log.npz/a.csv", "robot.toml", ["hip"], "cannot make the folder log.npz"),
    ],
)
def test_bad_requests_say_what_is_valid(
    source: Path, monkeypatch: pytest.MonkeyPatch, name: str, out: str, mapping: str, only: list[str], message: str
) -> None:
    monkeypatch.chdir(source.parent)
    with pytest.raises(FricompError, match=message):
        convert(Path(name), Path(out), mapping, only)


def test_bad_rows_of_a_native_recording_are_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(3000) / 500
    rows = [
        f"{t!r},{q!r},{tau!r}" for t, q, tau in np.column_stack([time, np.sin(time), np.sign(np.cos(time))]).tolist()
    ]
    rows[100] = rows[100].rpartition(",")[0] + ",nan"
    rows.insert(200, rows[200])
    source, out = tmp_path / "log.csv", tmp_path / "out.csv"
    source.write_text("time,position,torque\n" + "\n".join(rows) + "\n")
    convert(source, out, skip_bad_rows=True)
    assert "2 of 3001 rows were left out" in capsys.readouterr().out
    assert len(read_recording(out)) == 2999


@pytest.mark.parametrize("rate", [0.0, -5.0, float("nan"), float("inf")])
@pytest.mark.parametrize("mapping", ["", "robot.toml"])
def test_a_rate_that_is_none_is_refused(source: Path, mapping: str, rate: float) -> None:
    with pytest.raises(RecordingError, match="--rate is"):
        convert(source, source.with_name("a.csv"), mapping and str(source.with_name(mapping)), ["hip"], rate)


def test_what_was_read_is_not_written_over(source: Path) -> None:
    hip = source.with_name("hip.csv")
    convert(source, hip, str(source.with_name("robot.toml")), ["hip"])
    before = hip.read_bytes()
    with pytest.raises(OutputError, match="was read, and would be written over: choose another --out"):
        convert(hip, source.parent / "." / "hip.csv", rate=100.0)
    assert hip.read_bytes() == before


def test_two_joints_of_one_file_are_refused_before_anything_is_written(source: Path) -> None:
    mapping = source.with_name("robot.toml")
    mapping.write_text(MAPPING.replace('"hip"', '"l/e"\nsource = "hip"').replace('"knee"', '"l_e"\nsource = "knee"'))
    with pytest.raises(RecordingError, match=r"2 recordings would be .*leg_l_e.csv: choose one by --only"):
        convert(source, source.with_name("leg.csv"), str(mapping), force=True)
    assert not list(source.parent.glob("leg*"))


def test_two_recordings_of_one_name_are_refused_before_anything_is_written(
    source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    twice = intake.read_source(source, intake.Intake(str(source.with_name("robot.toml"))))[:1] * 2
    monkeypatch.setattr(intake, "read_source", lambda *_: twice)
    with pytest.raises(RecordingError, match=r"2 recordings would be .*: choose one by --only"):
        convert(source, source.with_name("leg.csv"), str(source.with_name("robot.toml")), force=True)
    assert not list(source.parent.glob("leg*"))


def test_a_gap_is_told_after_resampling_too(source: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.delete(np.arange(5000) / 500, np.s_[1000:3000])
    path = source.with_name("gap.csv")
    rows = np.column_stack([time, 0.5 * np.sin(4 * time), np.sign(np.cos(4 * time))]).tolist()
    path.write_text("time,position,torque\n" + "".join(f"{t!r},{q!r},{tau!r}\n" for t, q, tau in rows))
    convert(path, path.with_name("out.csv"), rate=250.0)
    assert capsys.readouterr().out.count("gap(s) in time, the longest 4.002 s") == 1
    assert len(read_recording(path.with_name("out.csv"))) == 1500


@pytest.mark.parametrize("rate", [100.0, 250.0])
def test_stamps_in_whole_seconds_are_refused_with_the_rate_of_the_rows(rate: float, tmp_path: Path) -> None:
    t = np.arange(0.0, 20.0, 1.0 / rate)
    rows = np.column_stack([np.floor(t), np.sin(2.0 * t), np.sign(np.cos(2.0 * t)) + 0.1 * np.cos(2.0 * t)])
    source = tmp_path / "log.csv"
    np.savetxt(source, rows, delimiter=",", header="timestamp,q_rad,tau_Nm", comments="")
    with pytest.raises(RecordingError, match=f"--row-rate {rate:g}"):
        convert(source, tmp_path / "joint.csv")
    convert(source, tmp_path / "joint.csv", row_rate=rate)
    assert len(read_recording(tmp_path / "joint.csv")) == t.size
