"""Commands killed with SIGKILL at random moments, and then repeated.

    python tests/cli/killed.py --commands identify export --count 50 --seed 0

Of two moments one is any of the run's time, at which it is killed from outside. The other is one of its file
operations, most of which take no time to speak of: a run counts them in the folder of its results by an audit hook, and
kills itself before one. Then the same command is called again, as a user would: it goes on with `--resume` where a
recording was begun. Charts are white, which saves half of the time and none of the files.

With `--every` no moment is left out: one whole run copies its folder aside before each of its file operations, which is
what a kill there leaves, and the command is called again on every copy that differs from the others.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model, save_model
from fricomp.recording import Recording, RecordingMetadata, read_blocks, read_recording, write_recording

if not __package__:  # as a script
    sys.path.insert(0, str(Path(__file__).parents[1]))
    __package__ = "cli"

from .warm import Ended, WarmProcess

__all__ = ["COMMANDS", "count_operations", "keep_leftovers", "kill_and_repeat", "repeat_on", "repeat_on_every_leftover"]

_RUNNER = """
import os, shutil, signal, sys
place, at, aside = arguments[0], int(arguments[1]), arguments[2]
count, copying = 0, False
def copy():
    global copying
    copying = True
    if os.path.isdir(place):
        shutil.copytree(place, os.path.join(aside, str(count)), symlinks=True)
    copying = False
def watch(event, about):
    global count
    if not copying and event in ("open", "os.rename", "os.remove", "os.mkdir", "os.truncate", "os.rmdir"):
        if isinstance(about[0], (str, bytes, os.PathLike)) and os.fsdecode(about[0]).startswith(place):
            count += 1
            if aside:
                copy()
            if count == at:
                os.kill(os.getpid(), signal.SIGKILL)
from fricomp.report import png
from PIL import Image
png._render = lambda figure: Image.new("RGB", (1, 1), "white")
sys.addaudithook(watch)
sys.argv = ["fricomp", *arguments[3:]]
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
        velocity = np.concatenate([-np.geomspace(0.01, 1.0, 16), np.geomspace(0.01, 1.0, 16)])
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
        time = np.arange(0.0, 5.2, 0.01)
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


def _call(warm: WarmProcess, folder: Path, command: list[str], at: float = 0, aside: str = "") -> Ended:
    """Call a command; it is killed before a file operation (int) or after a time [s] (float), if one is given."""
    operation, seconds = (0, {"seconds": at}) if isinstance(at, float) else (at, {})
    return warm.call(_RUNNER, [str(folder / "out"), str(operation), aside, *command], **seconds)


def count_operations(warm: WarmProcess, name: str, folder: Path) -> int:
    """File operations of a whole run of a command, whose results are checked too.

    Raises:
        AssertionError: It fails.
    """
    done = _call(warm, folder, COMMANDS[name](folder))
    assert done.returncode in (0, 1), done.told
    _check(name, folder)
    return _operations(done)


def _operations(done: Ended) -> int:
    return int(done.told.rpartition("operations: ")[2])


def kill_and_repeat(warm: WarmProcess, name: str, folder: Path, at: float) -> bool:
    """Kill a command at a moment, call it again, and look at what it leaves.

    Args:
        warm: Runs it.
        name: Of the command.
        folder: In which it runs.
        at: Number of the file operation (int) before which it is killed, or the time after which it is [s].

    Returns:
        Whether it was killed; False where it had come to its end before.

    Raises:
        AssertionError: A row is lost, a file is half or wrong, or the second call fails.
    """
    command = COMMANDS[name](folder)
    killed = _call(warm, folder, command, at)
    if killed.returncode != -signal.SIGKILL:
        assert killed.returncode in (0, 1), killed.told
        _check(name, folder)
        return False
    _repeat(warm, name, folder, command, at)
    return True


def repeat_on_every_leftover(warm: WarmProcess, name: str, folder: Path) -> tuple[int, int, list[str]]:
    """File operations of a command, how many different folders kills before them leave, and what is wrong with those.

    Raises:
        AssertionError: The command fails.
    """
    faults, seen = [], set[str]()
    operations, lefts = keep_leftovers(warm, name, folder)
    random.Random(0).shuffle(lefts)  # so that a run which is ended early has tried a fair sample
    for left in lefts:
        mark = _digest(left)
        if mark in seen:
            continue
        seen.add(mark)
        try:
            repeat_on(warm, name, folder, left)
        except AssertionError as error:
            faults.append(f"at {left.name}: {error}")
        sys.stderr.write(f"{name}: {len(seen)} leftovers, the last of operation {left.name}, {len(faults)} faults\n")
    return operations, len(seen), faults


def keep_leftovers(warm: WarmProcess, name: str, folder: Path) -> tuple[int, list[Path]]:
    """File operations of a whole run, and what a kill before each would leave, in their order.

    Raises:
        AssertionError: The command fails.
    """
    aside = folder / "aside"
    aside.mkdir()
    done = _call(warm, folder, COMMANDS[name](folder), aside=str(aside))
    assert done.returncode in (0, 1), done.told
    _check(name, folder)
    return _operations(done), sorted(aside.iterdir(), key=lambda each: int(each.name))


def repeat_on(warm: WarmProcess, name: str, folder: Path, left: Path) -> None:
    """Call a command on what a kill has left of its results; it is moved into their place.

    Raises:
        AssertionError: A row is lost, a file is half or wrong, or the call fails.
    """
    shutil.rmtree(folder / "out")
    shutil.move(left, folder / "out")
    _repeat(warm, name, folder, COMMANDS[name](folder), int(left.name))


def _digest(folder: Path) -> str:
    """Of names and contents; the number of a process in the name of an unfinished file is always the same here."""
    found = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        found.update(str(path.relative_to(folder)).encode() + b"\0")
        found.update(path.read_bytes() if path.is_file() else b"")
    return found.hexdigest()


def _repeat(warm: WarmProcess, name: str, folder: Path, command: list[str], at: float) -> None:
    """Call a command again that was killed, and look at what it leaves.

    Raises:
        AssertionError: A row is lost, a file is half or wrong, or the call fails.
    """
    _require_whole(folder / "out")
    rows = folder / "out" / "recording.csv"
    blocks = read_blocks(rows) if rows.exists() else ()
    kept = rows.read_bytes()[: _length(rows)] if blocks else b""
    if name == "calibrate" and (folder / "out" / "run.json").exists():
        command = ["calibrate", "--resume", "--out", str(folder / "out")]
    again = _call(warm, folder, command)
    is_finished = "(--overwrite)" in again.told and "already" in again.told
    assert is_finished or again.returncode in (0, 1), (at, again.told)
    assert not kept or rows.read_bytes().startswith(kept), f"rows are lost by a kill at {at}"
    _check(name, folder)


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
    parser.add_argument("--every", action="store_true")
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    with WarmProcess() as warm:
        for name in asked.commands:
            told, faults = _try_every(warm, name) if asked.every else _try_random(warm, name, asked.count, rng)
            sys.stdout.write(f"{name}: {told}, {len(faults)} faults\n")
            sys.stdout.writelines(f"  {fault}\n" for fault in faults[:10])
            sys.stdout.flush()


def _try_every(warm: WarmProcess, name: str) -> tuple[str, list[str]]:
    with tempfile.TemporaryDirectory() as place:
        operations, n_left, faults = repeat_on_every_leftover(warm, name, Path(place))
    return f"{operations} file operations, {n_left} different leftovers", faults


def _try_random(warm: WarmProcess, name: str, count: int, rng: np.random.Generator) -> tuple[str, list[str]]:
    for _ in range(2):  # the second run has its modules already
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as place:
            operations = count_operations(warm, name, Path(place))
        whole = time.monotonic() - start
    faults, killed = [], Counter[str]()
    for number in range(count):
        by_time = number % 2 == 0
        at = float(rng.uniform(0.0, whole)) if by_time else int(rng.integers(1, operations + 1))
        with tempfile.TemporaryDirectory() as place:
            try:
                is_killed = kill_and_repeat(warm, name, Path(place), at)
                killed["not"] += not is_killed
                killed["by time" if by_time else "by operation"] += is_killed
            except AssertionError as error:
                faults.append(f"at {at}: {error}")
                sys.stderr.write(f"{name}: {faults[-1]}\n")
        sys.stderr.write(f"{name}: {number + 1} of {count}, {dict(killed)}, {len(faults)} faults\n")
    moments = f"{killed['by time']} within {whole:.1f} s, {killed['by operation']} before {operations} operations"
    return f"kills: {moments}, {killed['not']} too late", faults


if __name__ == "__main__":
    _main()
