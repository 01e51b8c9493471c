"""MATLAB files up to version 7, read by scipy."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from fricomp.errors import MissingExtraError
from fricomp.recording.sources import own_process
from fricomp.recording.sources.columns import Columns, flatten_arrays, flatten_structures


def read_variables(path: Path) -> Columns:
    """The variables of a MATLAB file up to version 7; the fields of a structure are named with dots.

    Raises:
        MissingExtraError: scipy is not installed.
        RecordingError: The file is damaged.
    """
    if find_spec("scipy") is None:
        raise MissingExtraError("scipy", "convert")
    return own_process.read_in_process(__name__, path, "MATLAB").columns


def make_call(path: Path) -> list[str]:
    """What an interpreter of its own is called with."""
    return own_process.make_call(__name__, path)


def write_variables(path: str) -> None:
    """In the child: write all columns, and their names, to the standard output."""
    from scipy.io import loadmat

    try:
        content: dict[str, Any] = loadmat(path, simplify_cells=True)
    except Exception as error:  # the parser raises whatever damaged bytes make it stumble over
        own_process.refuse(f"is no MATLAB file: {error}")
    named = {name: value for name, value in content.items() if not name.startswith("__")}
    own_process.write_contents(flatten_arrays(flatten_structures(named)), {})
