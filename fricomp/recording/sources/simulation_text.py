"""Files of simulators, which hold a joint and no motion of it."""

import re
from pathlib import Path

from fricomp.errors import RecordingError

_SUFFIXES = (".xml", ".mjcf", ".urdf")
_ROOT = re.compile(rb"<(mujoco|robot)[\s>]")
_LOOKED_AT = 20_000
"""Bytes in which the root stands, below a licence."""


def refuse_simulation(path: Path) -> None:
    """Refuse an MJCF or URDF file as a log.

    Args:
        path: Of any file.

    Raises:
        RecordingError: It is one.
    """
    if path.suffix.lower() not in _SUFFIXES or not path.is_file():
        return
    with path.open("rb") as file:
        root = _ROOT.search(file.read(_LOOKED_AT))
    if root:
        kind = "MJCF" if root.group(1) == b"mujoco" else "URDF"
        raise RecordingError(
            f"{path} is a simulation ({kind}), and no recording: give it by --simulation, and here the log of a joint"
        )
