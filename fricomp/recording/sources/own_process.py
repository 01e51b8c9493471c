"""Parsers that are written in C and die of some damaged files, each file in a process of its own."""

import io
import json
import math
import signal
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.sources.columns import Columns, Contents

_CHILD = (
    "import resource; resource.setrlimit(resource.RLIMIT_CPU, ({patience}, {patience} + 9))\n"
    "import json, sys; sys.path[:] = json.loads(sys.argv[1])\n"
    "from importlib import import_module; import_module({module!r}).write_variables(sys.argv[2])"
)
_REFUSED = 3
"""Exit status of a child that says why on its standard error."""
_PATIENCE, _SLOWEST = 30.0, 5e6
"""Processor time that a file may take to read [s], and bytes a second of a large one: some damage leads a parser in
circles."""
_SHARED = 20.0
"""How much longer it may take where others use the processor too, or it waits for the disk."""


def make_call(module: str, path: Path) -> list[str]:
    """What an interpreter of its own is called with, in which a module reads a file.

    Args:
        module: Its `write_variables` takes the path and ends in `write_contents` or `refuse`.
        path: Of the file.
    """
    child = _CHILD.format(module=module, patience=math.ceil(find_patience(path)))
    return [sys.executable, "-W", "ignore", "-c", child, json.dumps(sys.path), str(path.absolute())]


def find_patience(path: Path) -> float:
    """Processor time that a file may take to read [s].

    Args:
        path: Of the file.
    """
    return _PATIENCE + path.stat().st_size / _SLOWEST


def read_in_process(module: str, path: Path, kind: str) -> Contents:
    """Read a file in a process of its own.

    Args:
        module: As for `make_call`.
        path: Of the file.
        kind: What it should be: `MATLAB`.

    Raises:
        RecordingError: It is damaged, or refused.
    """
    patience, call = find_patience(path), make_call(module, path)
    endless = f"{path} is no {kind} file: its reader came to no end in {patience:.0f} s"
    try:
        done = subprocess.run(
            call, check=False, stdin=subprocess.DEVNULL, capture_output=True, timeout=_SHARED * patience
        )
    except subprocess.TimeoutExpired as error:
        raise RecordingError(endless) from error
    if done.returncode == -signal.SIGXCPU:
        raise RecordingError(endless)
    if done.returncode == _REFUSED:
        raise RecordingError(f"{path} {done.stderr.decode(errors='replace')}")
    if done.returncode:
        raise RecordingError(f"{path} is no {kind} file: it is damaged so that its reader ended")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as archive:
        names, words = json.loads(str(archive["names"])), json.loads(str(archive["words"]))
        return Contents({name: archive[f"column_{number}"] for number, name in enumerate(names)}, words)


def write_contents(columns: Columns, words: dict[str, list[str]]) -> None:
    """In the child: write all columns, their names and the words beside them to the standard output."""
    arrays = {f"column_{number}": column for number, column in enumerate(columns.values())}
    said = {"names": np.array(json.dumps(list(columns))), "words": np.array(json.dumps(words))}
    stream = io.BytesIO()
    np.savez(stream, **arrays, **said)  # type: ignore[arg-type]
    sys.stdout.buffer.write(stream.getvalue())


def refuse(why: str) -> NoReturn:
    """In the child: end, and say what is wrong with the file."""
    sys.stderr.write(why)
    sys.exit(_REFUSED)
