"""Two commands that write one folder at once, each in a process of its own: the second is refused with who holds it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fricomp.folder_lock import LOCK_FILE, FolderLock
from fricomp.recording import read_recording

pytestmark = pytest.mark.slow

SWEEP = ["--speeds", "log:0.05:1:4", "--repeats", "1", "--dwell", "0.3", "--warm-up", "0", "--method", "least_squares"]
PATIENCE = 120.0  # for another process [s]

# The command stands where it has written run.json and begins its recording, until it gets a line.
_STANDING = """
import sys
place = sys.argv[1]
told = False
def watch(event, arguments):
    global told
    if not told and event == "open" and str(arguments[0]) == place and set(arguments[1] or "") & set("wxa+"):
        told = True
        print("holds", flush=True)
        sys.stdin.readline()
sys.addaudithook(watch)
sys.argv = ["fricomp", *sys.argv[2:]]
from fricomp.cli.main import run
run()
"""


def call(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "fricomp", *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=PATIENCE)


def begin(out: Path, *arguments: str) -> subprocess.Popen[str]:
    """A command that stands in the middle of its work, its folder begun."""
    command = [sys.executable, "-c", _STANDING, str(out / "recording.csv"), *arguments]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "holds\n"
    return process


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """A calibration that was interrupted: begun, and no plateau on disk."""
    folder = tmp_path / "run"
    begun = begin(folder, "calibrate", "--backend", "sim", *SWEEP, "--out", str(folder))
    begun.send_signal(signal.SIGKILL)
    begun.communicate()
    assert (folder / LOCK_FILE).exists(), "what a killed process leaves"
    return folder


OPTIONS = {
    "--overwrite": ["calibrate", "--backend", "sim", *SWEEP, "--overwrite"],
    "--resume": ["calibrate", "--resume"],
}


@pytest.fixture
def holder(request: pytest.FixtureRequest, out: Path) -> Iterator[subprocess.Popen[str]]:
    process = begin(out, *OPTIONS[request.param], "--out", str(out))
    yield process
    process.kill()
    process.communicate()


BOTH = [(first, second) for first in OPTIONS for second in OPTIONS]


@pytest.mark.parametrize(("holder", "second"), BOTH, indirect=["holder"])
def test_the_second_is_refused_with_who_holds_the_folder(holder: subprocess.Popen[str], second: str, out: Path) -> None:
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    refused = call(*OPTIONS[second], "--out", str(out))
    assert refused.returncode == 2
    said = " ".join(refused.stderr.split())
    assert f"is being written by process {holder.pid} since" in said
    assert "wait for it, end it, or choose another --out" in said
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    done, errors = holder.communicate("\n", timeout=PATIENCE)
    assert holder.returncode == 0, f"{done} {errors}"
    assert len(read_recording(out / "recording.csv")) > 0
    assert not (out / LOCK_FILE).exists()


@pytest.mark.parametrize("option", OPTIONS)
def test_the_lock_of_a_dead_process_is_taken_over(option: str, out: Path) -> None:
    with FolderLock.take(out) as lock:
        assert lock.left is not None
        dead = lock.left.pid
        lock.abandon()
    with pytest.raises(ProcessLookupError):
        os.kill(dead, 0)
    done = call(*OPTIONS[option], "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert not (out / LOCK_FILE).exists()
