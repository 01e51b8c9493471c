"""MATLAB files, read by scipy in a process of its own: its parser, written in C, dies of some damaged files."""

import io
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.sources.columns import Columns, flatten_arrays, flatten_structures

_CHILD = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1])\n"
    "from fricomp.recording.sources.mat_file import write_variables; write_variables(sys.argv[2])"
)
_REFUSED = 3  # exit status of a child that says why on its standard error


def read_variables(path: Path) -> Columns:
    """The variables of a MATLAB file up to version 7; the fields of a structure are named with dots.

    Raises:
        MissingExtraError: scipy is not installed.
        RecordingError: The file is damaged, or of version 7.3.
    """
    if find_spec("scipy") is None:
        raise MissingExtraError("scipy", "convert")
    done = subprocess.run(make_call(path), check=False, stdin=subprocess.DEVNULL, capture_output=True)
    if done.returncode == _REFUSED:
        raise RecordingError(f"{path} {done.stderr.decode(errors='replace')}")
    if done.returncode:
        raise RecordingError(f"{path} is no MATLAB file: it is damaged so that its reader ended")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as archive:
        names = json.loads(str(archive["names"]))
        return {name: archive[f"column_{number}"] for number, name in enumerate(names)}


def make_call(path: Path) -> list[str]:
    """What an interpreter of its own is called with."""
    return [sys.executable, "-W", "ignore", "-c", _CHILD, json.dumps(sys.path), str(path.absolute())]


def write_variables(path: str) -> None:
    """In the child: write all columns, and their names, to the standard output."""
    from scipy.io import loadmat

    try:
        content: dict[str, Any] = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        sys.stderr.write("is a MATLAB 7.3 file: save it in MATLAB with save(..., '-v7')")
        sys.exit(_REFUSED)
    except Exception as error:  # the parser raises whatever damaged bytes make it stumble over
        sys.stderr.write(f"is no MATLAB file: {error}")
        sys.exit(_REFUSED)
    named = {name: value for name, value in content.items() if not name.startswith("__")}
    columns = flatten_arrays(flatten_structures(named))
    stream, arrays = io.BytesIO(), {f"column_{number}": column for number, column in enumerate(columns.values())}
    np.savez(stream, **arrays, names=np.array(json.dumps(list(columns))))  # type: ignore[arg-type]
    sys.stdout.buffer.write(stream.getvalue())
