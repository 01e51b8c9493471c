"""`fricomp calibrate` as a user runs it, and as it goes wrong."""

import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import pytest
from typer.testing import CliRunner

from fricomp.calibration.sweep import load_sweep
from fricomp.cli.main import app
from fricomp.model import load_model

SHORT = ["--speeds", "0.01,0.03,0.05,0.08,0.3,1.5", "--repeats", "1", "--dwell", "0.4", "--warm-up", "0.5"]
QUICK = [*SHORT, "--method", "least_squares"]
COMMAND = [sys.executable, "-m", "fricomp.cli.main", "calibrate", "--backend", "sim"]


def _fails(*arguments: str) -> str:
    """The one sentence on stderr of a run that ends with status 2."""
    done = subprocess.run([*COMMAND, *arguments], check=False, capture_output=True, text=True, timeout=120)
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


def test_an_unknown_backend_is_one_sentence_with_the_known_ones() -> None:
    done = subprocess.run(
        [*COMMAND[:-2], "--backend", "telepathy"], check=False, capture_output=True, text=True, timeout=120
    )
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
    running = subprocess.Popen([*COMMAND, *QUICK, "--out", str(out)], stderr=subprocess.PIPE, text=True)
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
    kept = len(load_sweep(recording).of_kind("plateau"))
    assert kept >= 1  # a stop in the middle of a write takes that one back
    again = subprocess.run(
        [*COMMAND[:-2], "--resume", "--out", str(out)], check=False, capture_output=True, text=True, timeout=300
    )
    assert again.returncode == 0, again.stderr
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
