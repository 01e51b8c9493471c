"""`fricomp calibrate` as a user runs it, and as it goes wrong."""

import json
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.calibration.sweep import CalibrationRequest, MotionFile, RunFolder, load_sweep
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.calibration.sweep.weight import HungWeight
from fricomp.cli.calibration import torque_constant
from fricomp.cli.main import app
from fricomp.errors import FricompError, RecordingError
from fricomp.folder_lock import LOCK_FILE
from fricomp.model import load_model
from fricomp.overview import format_with_reach
from fricomp.recording import read_recording
from fricomp.recording.named.source import read_named_columns

from .called import call

SHORT = ["--speeds", "0.01,0.03,0.05,0.08,0.3,1.5", "--repeats", "1", "--dwell", "0.4", "--warm-up", "0.5"]
QUICK = [*SHORT, "--method", "least_squares"]
COMMAND = [sys.executable, "-m", "fricomp.cli.main", "calibrate", "--backend", "sim"]


def _fails(*arguments: str) -> str:
    """The one sentence on stderr of a run that ends with status 2."""
    done = call("calibrate", "--backend", "sim", *arguments)
    assert done.returncode == 2, done.stderr
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1, done.stderr
    assert "Traceback" not in done.stderr
    return lines[0]


def test_a_dry_run_prints_plan_and_accuracy_and_moves_nothing(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["calibrate", "--dry-run", "--out", str(tmp_path / "run")])
    assert result.exit_code == 0, result.output
    assert not (tmp_path / "run").exists()
    for word in ("travel", "speeds", "duration", "accuracy", "stribeck.reverse.viscous_coefficient"):
        assert word in result.output


def test_a_dry_run_says_what_its_speeds_cannot_determine(tmp_path: Path) -> None:
    speeds = ["--speeds", "1.0,1.1,1.2,1.3,1.4,1.5", "--out", str(tmp_path / "run")]
    result = CliRunner().invoke(app, ["calibrate", "--dry-run", *speeds])
    assert result.exit_code == 0, result.output
    assert "cannot be determined" in result.output
    assert "inf" not in result.output


@pytest.mark.parametrize(
    ("reach", "text"), [(0.0123, "1.500 ± 0.012"), (0.0, "1.500000 ± 0.000000"), (float("inf"), "cannot be determined")]
)
def test_a_result_is_printed_as_exactly_as_it_is_known(reach: float, text: str) -> None:
    assert format_with_reach(1.5, reach) == text


@pytest.fixture
def nothing_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever energises a joint fails the test."""

    def started(*_: object) -> None:
        pytest.fail("the joint was energised")

    monkeypatch.setattr(MotionRunner, "start", started)


def _refused(*arguments: str) -> str:
    """The sentence with which the command ends before it does anything."""
    result = CliRunner().invoke(app, ["calibrate", *arguments])
    assert isinstance(result.exception, FricompError), result.output
    return str(result.exception)


@pytest.fixture
def motion(tmp_path: Path) -> Path:
    file = tmp_path / "motion.csv"
    file.write_text("time,velocity\n0,0\n0.5,0.4\n1,0\n")
    return file


@pytest.mark.usefixtures("nothing_moves")
def test_a_dry_run_of_a_hung_weight_prints_its_passes_and_moves_nothing(tmp_path: Path) -> None:
    out = tmp_path / "run"
    asked = ["calibrate", "--torque-constant", "--weight", "0.5", "--lever", "0.25", "--dry-run", "--out", str(out)]
    result = CliRunner().invoke(app, asked)
    assert result.exit_code == 0, result.output
    assert not out.exists()
    for word in ("travel", "passes", "fastest", "duration", "0.5 kg"):
        assert word in result.output


@pytest.mark.usefixtures("nothing_moves")
def test_a_dry_run_of_a_motion_prints_that_motion(tmp_path: Path, motion: Path) -> None:
    out = tmp_path / "run"
    result = CliRunner().invoke(app, ["calibrate", "--motion", str(motion), "--dry-run", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert not out.exists()
    assert "-0.1 to 0.1 rad" in result.output
    assert "in the middle" in result.output
    assert "plateaus" not in result.output


@pytest.mark.usefixtures("nothing_moves")
def test_a_dry_run_of_a_motion_says_where_it_will_be(motion: Path) -> None:
    motion.write_text("time,velocity,position\n0,0,1.2\n0.5,0.4,1.3\n1,0,1.4\n")
    result = CliRunner().invoke(app, ["calibrate", "--motion", str(motion), "--dry-run"])
    assert "1.2 to 1.4 rad" in result.output
    assert "start     1.2 rad" in result.output


def test_a_motion_outside_the_travel_is_refused_and_the_way_out_said(tmp_path: Path, motion: Path) -> None:
    motion.write_text("time,velocity,position\n0,0,2.7\n0.5,0.4,2.8\n1,0,2.9\n")
    said = _refused("--motion", str(motion), "--out", str(tmp_path / "run"))
    assert "ends 0.127 above it" in said
    assert "leave out that column" in said
    assert not (tmp_path / "run").exists()


def test_a_motion_is_recorded_where_it_was_and_can_be_diagnosed(tmp_path: Path, motion: Path) -> None:
    motion.write_text("time,velocity,position\n0,0,1.2\n0.5,0.4,1.3\n1,0,1.4\n")
    out = tmp_path / "run"
    result = CliRunner().invoke(app, ["calibrate", "--motion", str(motion), "--out", str(out)])
    assert f"fricomp diagnose OLD {out / 'motion-alone.csv'}" in result.output
    assert f"fricomp identify {out / 'recording.csv'}" in result.output
    alone = read_recording(out / "motion-alone.csv")
    assert alone.position[[0, -1]] == pytest.approx([1.2, 1.4], abs=5e-3)
    assert alone.duration == pytest.approx(1.0, abs=0.01)  # no gap in time, as between the blocks of a run


def test_a_dry_run_of_a_motion_that_does_not_fit_says_so(motion: Path) -> None:
    motion.write_text("time,velocity\n0,0\n5,3\n10,3\n")
    assert "travel" in _refused("--motion", str(motion), "--dry-run")


@pytest.mark.usefixtures("nothing_moves")
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("--normal-load foo", "none of none"),
        ("--normal-load column", "no normal_load column"),
        ("--normal-load -3", "positive"),
        ("--normal-load transmitted", "no model says that a load acts"),
        ("--seed -1", "seed must be at least 0"),
        ("--speeds 0.03,0.1,0.4 --repeats 1", "would have 8 plateaus, at least 10"),
        ("--speeds 0.03,0.1,0.4,1.5 --repeats 1 --adaptive", "would have 8 plateaus"),
        ("--gravity-unknown --adaptive", "adaptive sweep needs the gravity torque"),
        ("--warm-up inf", "finite"),
        ("--accuracy nan", "accuracy must be positive"),
        ("--weight 0.5 --lever 0.25", "belongs to --torque-constant"),
        ("--torque-constant --weight inf --lever 0.25", "finite"),
        ("--torque-constant --motion m.csv", "leave out --motion"),
        ("--loop host --backend twin-moteus", "inertia"),
    ],
)
def test_what_cannot_come_to_an_end_is_refused_before_anything_moves(
    tmp_path: Path, arguments: str, words: str
) -> None:
    out = tmp_path / "run"
    assert words in _refused(*arguments.split(), "--out", str(out))
    assert not out.exists()


def test_a_run_that_cannot_be_done_leaves_the_one_that_it_would_replace(tmp_path: Path, motion: Path) -> None:
    out = tmp_path / "run"
    assert CliRunner().invoke(app, ["calibrate", "--motion", str(motion), "--out", str(out)]).exit_code == 0
    kept = (out / "recording.csv").read_bytes()
    _refused("--normal-load", "transmitted", "--overwrite", "--out", str(out))
    assert (out / "recording.csv").read_bytes() == kept


def test_a_motion_is_not_resumed_as_a_sweep_and_is_replaced_only_when_told(
    tmp_path: Path, motion: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, record = tmp_path / "run", ["--motion", str(motion), "--out", str(tmp_path / "run")]
    whole = MotionFile.velocity_at

    def interrupted(self: MotionFile, seconds: float) -> float | None:
        if seconds > 0.6:
            raise KeyboardInterrupt
        return whole(self, seconds)

    with monkeypatch.context() as patch:
        patch.setattr(MotionFile, "velocity_at", interrupted)
        CliRunner().invoke(app, ["calibrate", *record])
    ((label, samples),) = load_sweep(out / "recording.csv").of_kind("motion")
    assert label.is_cut
    assert samples.duration == pytest.approx(0.6, abs=0.01)
    assert "a motion begins at its beginning" in _refused("--resume", "--out", str(out))
    assert "--resume" not in _refused(*record)
    assert CliRunner().invoke(app, ["calibrate", *record, "--overwrite"]).exit_code == 0
    ((label, samples),) = load_sweep(out / "recording.csv").of_kind("motion")
    assert not label.is_cut
    assert "recorded to its end" in _refused("--resume", "--out", str(out))


def test_options_that_a_resumed_run_would_ignore_are_refused_by_name(tmp_path: Path) -> None:
    request = CalibrationRequest("sim", {"seed": 0, "model": "default_joint"})
    out = str(RunFolder.create(tmp_path / "run", request).path)
    said = _refused(
        "--resume", "--out", out, "--backend", "sim", "--repeats", "3", "--seed", "2", "--dry-run", "--quiet"
    )
    assert "--dry-run, --repeats, --seed cannot be changed" in said


def test_a_run_folder_that_asks_for_nonsense_takes_another_method(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path / "run", CalibrationRequest("sim"))
    file = folder.path / "run.json"
    file.write_text(file.read_text().replace('"pinn"', '"foo"'))
    with pytest.raises(RecordingError, match="--method"):
        RunFolder.resume(folder.path)
    again = RunFolder.resume(folder.path, {"method": "least_squares", "normal_load": "3"})
    assert again.request.options.identification.method == "least_squares"
    assert again.request.options.normal_load == "3"


@pytest.mark.usefixtures("nothing_moves")
def test_a_motion_is_not_replaced_by_its_own_recording(tmp_path: Path, motion: Path) -> None:
    file = tmp_path / "motion-alone.csv"
    file.write_text(motion.read_text())
    said = _refused("--motion", str(file), "--out", str(tmp_path), "--overwrite")
    assert "would replace the motion" in said
    assert file.read_text() == motion.read_text()


def test_a_torque_constant_that_replaces_another_leaves_nothing_of_it_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("torque_constant.json", "bare-0.csv", "loaded-3.csv", "notes.txt"):
        (tmp_path / name).write_text("old")

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    request = CalibrationRequest("sim", {"seed": 0, "model": "default_joint"})
    monkeypatch.setattr(torque_constant, "_record", interrupted)
    with pytest.raises(KeyboardInterrupt):
        torque_constant.measure_torque_constant(request, HungWeight(0.5, 0.25), tmp_path, overwrite=True)
    assert {path.name for path in tmp_path.iterdir()} == {LOCK_FILE, "notes.txt"}


def test_a_torque_constant_is_replaced_only_when_told(tmp_path: Path) -> None:
    out = tmp_path / "run"
    out.mkdir()
    (out / "torque_constant.json").write_text("{}")
    said = _refused("--torque-constant", "--weight", "0.5", "--lever", "0.25", "--out", str(out))
    assert "replace it (--overwrite)" in said
    assert (out / "torque_constant.json").read_text() == "{}"


def test_a_drive_without_its_file_says_how_to_give_it(tmp_path: Path) -> None:
    said = _refused("--backend", "canopen", "--out", str(tmp_path / "run"))
    assert "give the drive's file with --config" in said


def test_an_unknown_backend_is_one_sentence_with_the_known_ones() -> None:
    done = call("calibrate", "--backend", "telepathy")
    assert done.returncode == 2
    assert "unknown backend 'telepathy'" in done.stderr
    assert "sim" in done.stderr


def test_a_folder_that_cannot_be_written_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert "cannot make the folder" in _fails("--out", str(tmp_path / "file" / "run"))


def test_an_unknown_joint_is_one_sentence(tmp_path: Path) -> None:
    assert "no joint 'elbow'; this backend has joint" in _fails("--joint", "elbow", "--out", str(tmp_path / "run"))


def test_nothing_to_resume_is_one_sentence(tmp_path: Path) -> None:
    assert "nothing to resume" in _fails("--resume", "--out", str(tmp_path / "run"))


@pytest.mark.slow
def test_a_run_leaves_everything_in_its_folder(tmp_path: Path) -> None:
    out = tmp_path / "run"
    done = subprocess.run(
        [*COMMAND, *SHORT, "--out", str(out)], check=False, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""  # no progress bar where nobody watches
    assert "coulomb torque" in done.stdout
    assert {"run.json", "recording.csv", "friction.json", "friction.onnx", "report.html"} <= {
        f.name for f in out.iterdir()
    }
    assert len(list(out.glob("*.png"))) >= 4
    assert load_model(out / "friction.json").forward.coulomb_torque == pytest.approx(0.15, rel=0.02)
    run = msgspec.json.decode((out / "run.json").read_bytes())
    assert run["status"] == "done"
    assert {"versions", "request", "results"} <= set(run)
    assert run["request"]["settings"]["seed"] == 0


@pytest.mark.slow
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_a_run_that_is_stopped_goes_on_where_it_was(tmp_path: Path, number: int, status: int) -> None:
    out = tmp_path / "run"
    log = tmp_path / "sweep.mcap"
    running = subprocess.Popen(
        [*COMMAND, *QUICK, "--log", str(log), "--out", str(out)], stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 120.0
    recording = out / "recording.csv"
    while not (recording.exists() and recording.read_text().count('\\"plateau\\"') >= 2):
        assert time.monotonic() < deadline
        assert running.poll() is None, running.communicate()[1]
    running.send_signal(number)
    _, said = running.communicate(timeout=60)
    assert running.returncode == status
    if number != signal.SIGKILL:
        assert "zero torque" in said
        assert "--resume" in said
        assert read_named_columns(log)["joint.position"].size == len(read_recording(recording))
    kept = len(load_sweep(recording).of_kind("plateau"))
    assert kept >= 1  # a stop in the middle of a write takes that one back
    again = subprocess.run(
        [*COMMAND[:-2], "--resume", "--quiet", "--out", str(out)],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert again.returncode == 0, again.stderr
    assert again.stdout == ""
    numbers = [label.number for label, _ in load_sweep(recording).of_kind("plateau")]
    assert numbers == list(range(14))


@pytest.mark.slow
def test_a_full_disk_is_one_sentence_and_keeps_what_was_written(tmp_path: Path) -> None:
    """The file may not grow past half a megabyte, which fails in the same call as a full disk."""
    out = tmp_path / "run"
    done = subprocess.run(
        [*COMMAND, *SHORT, "--out", str(out)],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500_000, 500_000)),
    )
    assert done.returncode == 2, done.stderr
    (sentence,) = done.stderr.strip().splitlines()
    assert "cannot write" in sentence
    assert "rows are safe on disk" in sentence
    assert load_sweep(out / "recording.csv").blocks


@pytest.mark.slow
def test_the_log_of_a_sweep_holds_its_motion_and_what_the_model_leaves(tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    log = tmp_path / "sweep.mcap"
    result = CliRunner().invoke(app, ["calibrate", *QUICK, "--out", str(tmp_path / "run"), "--log", str(log)])
    assert result.exit_code == 0, result.output
    columns = read_named_columns(log)
    kept = read_recording(tmp_path / "run" / "recording.csv")
    assert columns["joint.position"] == pytest.approx(kept.position, abs=1e-9)
    moving = np.abs(columns["joint.velocity"]) > 0.2
    friction, left = np.abs(columns["joint.model"][moving]), np.abs(columns["joint.residual"][moving])
    assert np.median(left) < 0.1 * np.median(friction)


def test_a_model_that_is_not_usable_ends_with_a_status_of_its_own(tmp_path: Path) -> None:
    fast = ["--speeds", "1.1,1.2,1.3,1.4,1.5", "--repeats", "1", "--dwell", "0.4", "--warm-up", "0.5"]
    out = tmp_path / "run"
    result = CliRunner().invoke(app, ["calibrate", *fast, "--method", "least_squares", "--json", "--out", str(out)])
    assert result.exit_code == 1, result.output
    assert json.loads(result.stdout)["usable"] is False
    assert (out / "friction.json").exists()
    again = CliRunner().invoke(app, ["calibrate", "--resume", "--out", str(out)])
    assert again.exit_code == 1, again.output
    assert "NOT USABLE" in again.output
