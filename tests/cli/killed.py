"""Commands killed with SIGKILL at a random one of their file operations, and then repeated.

    python tests/cli/killed.py --commands identify export --count 50 --seed 0

A run counts its file operations in the folder of its results by an audit hook, and kills itself before one of them.
Then the same command is called again, as a user would: it goes on with `--resume` where a recording was begun.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model, save_model
from fricomp.recording import Recording, RecordingMetadata, read_blocks, read_recording, write_recording

__all__ = ["COMMANDS", "count_operations", "kill_and_repeat"]

_RUNNER = """
import os, signal, sys
place, at = sys.argv[1], int(sys.argv[2])
count = 0
def watch(event, arguments):
    global count
    if event in ("open", "os.rename", "os.remove", "os.mkdir", "os.truncate", "os.rmdir"):
        if isinstance(arguments[0], (str, bytes, os.PathLike)) and os.fsdecode(arguments[0]).startswith(place):
            count += 1
            if count == at:
                os.kill(os.getpid(), signal.SIGKILL)
sys.addaudithook(watch)
sys.argv = ["fricomp", *sys.argv[3:]]
from fricomp.cli.main import run
try:
    run()
finally:
    sys.stderr.write(f"operations: {count}")
"""
_SPEEDS = ("--speeds", "log:0.05:1:4", "--repeats", "1", "--dwell", "0.3", "--warm-up", "0")


def _identify(folder: Path) -> list[str]:
    path = folder / "points.csv"
    if not path.exists():
        velocity = np.concatenate([-np.geomspace(0.01, 1.0, 40), np.geomspace(0.01, 1.0, 40)])
        noise = np.random.default_rng(0).normal(0.0, 0.003, velocity.size)
        curve = 0.2 + 0.3 * np.exp(-((velocity / 0.05) ** 2)) + 0.1 * np.abs(velocity)
        table = np.column_stack([velocity, np.sign(velocity) * curve + noise])
        np.savetxt(path, table, delimiter=",", header="velocity,torque", comments="")
    return ["identify", str(path), "--method", "least_squares", "--out", str(folder / "out")]


def _export(folder: Path) -> list[str]:
    path = folder / "friction.json"
    law = FrictionLaw((Stribeck(StribeckCurve(0.2, 0.5, 0.05, 0.1)),))
    if not path.exists():
        save_model(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0))), path)
    return ["export", str(path), "--to", "c", "--out", str(folder / "out" / "friction.h")]


def _calibrate(folder: Path) -> list[str]:
    return ["calibrate", "--backend", "sim", *_SPEEDS, "--method", "least_squares", "--out", str(folder / "out")]


def _diagnose(folder: Path) -> list[str]:
    path = folder / "elbow.csv"
    if not path.exists():
        time = np.arange(0.0, 12.0, 0.004)
        position = 0.8 * np.sin(1.3 * time) + 0.5 * np.sin(2.9 * time)
        velocity = 1.04 * np.cos(1.3 * time) + 1.45 * np.cos(2.9 * time)
        acceleration = -1.352 * np.sin(1.3 * time) - 4.205 * np.sin(2.9 * time)
        noise = np.random.default_rng(0).normal(0.0, 0.01, time.size)
        torque = 0.3 * acceleration + 0.4 * np.tanh(velocity / 0.01) + 0.2 * velocity + noise
        channels = {"time": time, "position": position, "torque": torque}
        write_recording(Recording.from_channels(channels, RecordingMetadata(joint="elbow")), path)
    return ["diagnose", str(path), "--out", str(folder / "out")]


COMMANDS: dict[str, Callable[[Path], list[str]]] = {
    "identify": _identify,
    "export": _export,
    "calibrate": _calibrate,
    "diagnose": _diagnose,
}
"""What is called, by its name; each makes what it needs in a folder, and writes into `out` there."""


def _call(folder: Path, command: list[str], at: int = 0) -> subprocess.CompletedProcess[str]:
    call = [sys.executable, "-c", _RUNNER, str(folder / "out"), str(at), *command]
    return subprocess.run(call, check=False, capture_output=True, text=True)


def count_operations(name: str, folder: Path) -> int:
    """File operations of a whole run of a command, whose results are checked too.

    Raises:
        AssertionError: It fails.
    """
    done = _call(folder, COMMANDS[name](folder))
    assert done.returncode in (0, 1), done.stderr
    _check(name, folder)
    return int(done.stderr.rpartition("operations: ")[2])


def kill_and_repeat(name: str, folder: Path, at: int) -> None:
    """Kill a command before one of its file operations, call it again, and look at what it leaves.

    Raises:
        AssertionError: A row is lost, a file is half or wrong, or the second call fails.
    """
    command = COMMANDS[name](folder)
    killed = _call(folder, command, at)
    if killed.returncode != -signal.SIGKILL:
        assert killed.returncode in (0, 1), killed.stderr
        return _check(name, folder)  # it had fewer operations this time
    _require_whole(folder / "out")
    rows = folder / "out" / "recording.csv"
    blocks = read_blocks(rows) if rows.exists() else ()
    kept = rows.read_bytes()[: _length(rows)] if blocks else b""
    if name == "calibrate" and (folder / "out" / "run.json").exists():
        command = ["calibrate", "--resume", "--out", str(folder / "out")]
    again = _call(folder, command)
    is_finished = "already: replace it (--overwrite)" in again.stderr or "is there already" in again.stderr
    assert is_finished or again.returncode in (0, 1), (at, again.stderr)
    assert not kept or rows.read_bytes().startswith(kept), f"rows are lost by a kill at {at}"
    return _check(name, folder)


def _length(rows: Path) -> int:
    """Bytes of a recording up to the end of its last whole block."""
    data = rows.read_bytes()
    start = data.rfind(b"# block: ")
    return data.find(b"\n", start) + 1


def _require_whole(out: Path) -> None:
    """Whatever is there under its own name is whole."""
    for path in out.glob("*") if out.exists() else ():
        if path.name.startswith("."):
            continue
        if path.suffix == ".json":
            json.loads(path.read_bytes())
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82"), path
        elif path.suffix == ".html":
            assert path.read_text().rstrip().endswith("</html>"), path
        elif path.suffix == ".h":
            assert "#endif" in path.read_text().rstrip().rpartition("\n")[2], path


def _check(name: str, folder: Path) -> None:
    """The results of a command that has come to its end: whole, of one piece, and nothing beside them."""
    out = folder / "out"
    _require_whole(out)
    left = [path.name for path in out.iterdir() if path.name.startswith(".")]
    assert not left, left
    if name in ("identify", "calibrate"):
        model = load_model(out / "friction.json")
        assert model.forward.static_torque > model.forward.coulomb_torque
        assert (out / "report.html").exists()
        assert (out / "friction.onnx").exists()
    if name == "calibrate":
        assert json.loads((out / "run.json").read_bytes())["status"] == "done"
        assert len(read_recording(out / "recording.csv")) > 0
    if name == "diagnose":
        assert (out / "diagnosis.json").exists()
        assert (out / "report.html").exists()


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    for name in asked.commands:
        with tempfile.TemporaryDirectory() as place:
            operations = count_operations(name, Path(place))
        faults = []
        for _ in range(asked.count):
            at = int(rng.integers(1, operations + 1))
            with tempfile.TemporaryDirectory() as place:
                try:
                    kill_and_repeat(name, Path(place), at)
                except AssertionError as error:
                    faults.append(f"at {at}: {error}")
        sys.stdout.write(f"{name}: {asked.count} kills over {operations} file operations, {len(faults)} faults\n")
        sys.stdout.writelines(f"  {fault}\n" for fault in faults[:10])
        sys.stdout.flush()


if __name__ == "__main__":
    _main()
