"""Damaged, strange and hostile recordings, models, configurations and mappings without end.

    python tests/recording/hostile_files.py --count 100000 --formats csv parquet --seed 0

One reader by turns answers each with a result or an error of its own. Of three copies one is damaged, one is damaged or
well formed with other values, and one is a well-formed file of another schema. A child process reads the files, with a
limit on its memory and on the time of each: what kills it, such as a fault in a parser written in C, is told with the
file that did. MATLAB files, each of which is read by a process of its own, are read by a copy of that child, one after
another until one kills it. Files lie in memory where the system has a place for that (`/dev/shm`). A line is written
for each batch of files, so that a run that was stopped goes on by `--first`.
"""

from __future__ import annotations

import argparse
import faulthandler
import io
import multiprocessing
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from multiprocessing.connection import Connection
from pathlib import Path
from unittest.mock import patch

import numpy as np

from fricomp.errors import FricompError
from fricomp.recording.sources import mat_file

if not __package__:  # as a script
    sys.path.insert(0, str(Path(__file__).parents[1]))
    __package__ = "recording"

from .hostile.damage import damage
from .hostile.whole import FORMATS, write_seed_file

__all__ = ["FORMATS", "Outcome", "read_hostile", "write_seed_file"]

MEMORY = 3 * 2**30  # of a reader [bytes]; content of 1 GiB, twice, and the libraries
SECONDS = 20  # for one file; a usual one takes a hundredth of a second
BATCH = 10_000  # files that one child reads
PLACE = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None  # deleting a file on a disk takes half of the time

Outcome = Counter[str]
"""How many files were read, refused, and each kind of fault, by name."""


class TooSlow(BaseException):
    """A file that takes longer than any other would."""


def _expire(*_: object) -> None:
    raise TooSlow


def read_hostile(name: str, count: int, seed: int, *, first: int = 0, at: Path | None = None) -> Outcome:
    """Read damaged and strange copies of one file in this process.

    Args:
        name: Of the format.
        count: Copies.
        seed: Of the damage; copy k of a seed is always the same.
        first: Number of the first copy.
        at: File in which the number of each copy is written before it is read.

    Returns:
        What came of them; a fault is named by its kind and the number of the copy that showed it first.
    """
    outcome: Outcome = Counter()
    before = signal.signal(signal.SIGALRM, _expire)
    try:
        with tempfile.TemporaryDirectory(dir=PLACE) as folder:
            whole = Path(folder) / "whole"
            whole.mkdir()
            write_seed_file(name, whole)
            for number in range(first, first + count):
                if at is not None:
                    at.write_text(str(number))
                path = _write_copy(name, whole, Path(folder) / "copy", np.random.default_rng([seed, number]), number)
                readers = FORMATS[name].readers
                outcome[_try(readers[number // 3 % len(readers)], path, number)] += 1
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    return outcome


def _write_copy(name: str, whole: Path, place: Path, rng: np.random.Generator, number: int) -> Path:
    """Write the file, or the folder, that is read next, alone in a folder."""
    found = FORMATS[name]
    shutil.rmtree(place, ignore_errors=True)
    if found.strange is not None and number % 3 == 2:
        place.mkdir()
        found.strange(place / found.file, rng)
        if rng.random() < 0.8:
            return place / found.file
    else:
        shutil.copytree(whole, place)
    files = sorted(path for path in place.rglob("*") if path.is_file())
    hit = files[int(rng.integers(0, len(files)))]
    spoil = found.exchange if found.exchange is not None and number % 3 == 1 else damage
    hit.write_bytes(spoil(hit.read_bytes(), rng))
    return place / found.file


def _try(read: Callable[[Path], object], path: Path, number: int) -> str:
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    try:
        read(path)
    except FricompError as error:
        return "refused" if str(error).strip() else f"refused without a word, copy {number}"
    except TooSlow:
        return f"slow, copy {number}"
    except BaseException as error:
        return f"{type(error).__name__}: {str(error)[:100]}, {read.__name__}, copy {number}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    return "read"


class MatlabReader:
    """Stands in for `subprocess.run` where a MATLAB file is read by an interpreter of its own.

    A copy of this process reads one file after another, until one kills it; another copy goes on then. A new
    interpreter for each would take a hundred times as long.
    """

    def __init__(self) -> None:
        self._copy: multiprocessing.process.BaseProcess | None = None

    def run(self, call: Sequence[str], **_options: object) -> subprocess.CompletedProcess[bytes]:
        """Read the file that the call names, in the copy."""
        if self._copy is None:
            self._copy, self._line = _start_copy()
        try:
            self._line.send(call[-1])
            status, told, complained = self._line.recv()
        except EOFError:  # the file has killed it
            self._copy.join()
            status, told, complained = self._copy.exitcode or 1, b"", b""
            self._copy = None
        except BaseException:
            self._copy.kill()
            self._copy = None
            raise
        return subprocess.CompletedProcess(call, status, told, complained)


def _start_copy() -> tuple[multiprocessing.process.BaseProcess, Connection]:
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()
    copy = context.Process(target=_read_one_by_one, args=(theirs, ours), daemon=True)
    copy.start()
    theirs.close()
    return copy, ours


def _read_one_by_one(line: Connection, other_end: Connection) -> None:
    """In the copy: answer each path with the exit status and what went to both outputs."""
    other_end.close()
    warnings.simplefilter("ignore")
    faulthandler.disable()  # the exit status says enough of a copy that dies
    while True:
        try:
            path = line.recv()
        except EOFError:
            return
        told, complained, status = io.BytesIO(), io.StringIO(), 0
        with redirect_stdout(io.TextIOWrapper(told)), redirect_stderr(complained):
            try:
                mat_file.write_variables(path)
            except SystemExit as end:
                status = int(end.code or 0)
            except BaseException:
                status = 1
            line.send((status, told.getvalue(), complained.getvalue().encode(errors="replace")))


def _read_in_child(name: str, count: int, seed: int, first: int) -> Outcome:
    """Outcome of a batch; after a copy that kills the reader another one goes on."""
    found: Outcome = Counter()
    last = first + count
    with tempfile.TemporaryDirectory(dir=PLACE) as folder:
        at = Path(folder) / "at"
        while first < last:
            at.write_text(str(first))
            command = [sys.executable, __file__, "--child", str(at), "--formats", name, "--seed", str(seed)]
            command += ["--first", str(first), "--count", str(last - first)]
            done = subprocess.run(command, check=False, capture_output=True, text=True)
            for line in done.stdout.splitlines():
                often, _, what = line.partition(" ")
                if often.isdigit():  # libraries in other languages write there too
                    found[what] += int(often)
            if not done.returncode:
                break
            found[f"the reader died with {done.returncode}, copy {at.read_text()}"] += 1
            found["not told of"] += int(at.read_text()) - first
            first = int(at.read_text()) + 1
    return found


def _be_child(name: str, count: int, seed: int, first: int, at: Path) -> None:
    """Read a batch, and write what came of it, with the memory and the time that it took."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    faulthandler.dump_traceback_later(10 * SECONDS + count, exit=True)  # a loop in a library, which hears no signal
    warnings.simplefilter("ignore")
    outcome: Outcome = Counter()
    sizes, began = [], time.monotonic()
    with patch.object(subprocess, "run", MatlabReader().run):
        for part in range(4):
            start = first + part * count // 4
            outcome += read_hostile(name, first + (part + 1) * count // 4 - start, seed, first=start, at=at)
            sizes.append(int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() // 2**20)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 2**10
    for what, often in outcome.items():
        sys.stdout.write(f"{often} {' '.join(what.split())}\n")
    spent = f"{time.monotonic() - began:.0f} s; MiB after each quarter {sizes}, at most {peak}"
    sys.stdout.write(f"1 [{spent}]\n")


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=list(FORMATS))
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--child", type=Path, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.child is not None:
        _be_child(asked.formats[0], asked.count, asked.seed, asked.first, asked.child)
        return
    for name in asked.formats:
        for first in range(asked.first, asked.first + asked.count, BATCH):
            count = min(BATCH, asked.first + asked.count - first)
            outcome = _read_in_child(name, count, asked.seed, first)
            told = ", ".join(f"{what}: {often}" for what, often in outcome.most_common(40))
            sys.stdout.write(f"{name}, {count} files from {first}: {told}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    _main()
