"""Logs of bare frames of a CAN bus, or of bytes in hexadecimal, which do not say what they hold."""

import re
from collections.abc import Sequence
from pathlib import Path

from fricomp.errors import RecordingError

_FRAME = re.compile(
    r"^(?:\(?[\d.: -]++\)?\s*+)?\w*can\w*\s+[0-9A-F]{3,8}(?:#{1,2}[0-9A-F]*|\s+(?:\[\d+\]\s+)?(?:[0-9A-F]{2}\s*)+)"
    r"(?:\s+[RT])?$"
    r"|^[\d.]+\s+\d+\s+[0-9A-F]{3,8}x?\s+(?:Rx|Tx)\s+d\s+\d",
    re.IGNORECASE,
)
"""A line of `candump`, or of the ASC files of Vector."""
_OF_VECTOR = re.compile(r"^[\d.]+\s+\d+\s+[0-9A-F]{3,8}x?\s+(?:Rx|Tx)\s+d\s+\d", re.IGNORECASE)
"""A line of an ASC file."""
SUFFIXES_OF_FRAMES = (".blf", ".trc")
"""Files of frames that python-can writes anew as lines of `candump`."""
_MOSTLY = 0.5
_LONGEST = 400
"""Characters of a line that are looked at: a frame of 64 bytes has 260."""
_BYTES = re.compile(r"(?<![\w.])(?=\w*\d)(?=\w*[a-f])(?:0x)?(?:[0-9a-f]{2}){8,}(?![\w.])", re.IGNORECASE)
"""Eight bytes and more in hexadecimal."""


def refuse_frames(path: Path, lines: Sequence[str]) -> None:
    """Refuse a log of bare frames, with how to decode it.

    Args:
        path: Of the file, for the message.
        lines: The first ones of a text.

    Raises:
        RecordingError: Most of them are frames.
    """
    said = [line.strip()[:_LONGEST] for line in lines if line.strip()]
    if sum(_FRAME.match(line) is not None for line in said) > _MOSTLY * len(said):
        raise RecordingError(explain_frames(path, converted=any(map(_OF_VECTOR.match, said))))


def explain_frames(path: Path, *, converted: bool) -> str:
    """What to do with a log of bare frames.

    Args:
        path: Of the file.
        converted: Whether it is to be written as lines of `candump` first, which alone are decoded.
    """
    lines = path.with_suffix(".candump.log").name if converted else path.name
    first = f"write it as lines by 'python -m can.logconvert {path.name} {lines}', and " if converted else ""
    return (
        f"{path} holds bare frames of a CAN bus, which do not say what their bytes are: {first}decode "
        f"{'these' if converted else 'it'} by the description of the drive, such as "
        f"'python -m cantools decode --single-line drive.dbc < {lines} > decoded.log', whose lines are read by "
        "themselves"
    )


def refuse_bytes(path: Path, lines: Sequence[str]) -> None:
    """Refuse a log that holds bytes in place of numbers.

    Args:
        path: Of the file, for the message.
        lines: Some of a text.

    Raises:
        RecordingError: Some of them have bytes in hexadecimal.
    """
    if any(_BYTES.search(line[:_LONGEST]) for line in lines):
        raise RecordingError(
            f"{path} holds bytes in hexadecimal, which do not say what they are: decode them, as by struct.unpack of "
            "Python, and write a table with a column of numbers each for time, position and torque"
        )
