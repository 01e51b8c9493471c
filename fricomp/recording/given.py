"""What a caller gives as a recording: one, a data frame that holds one, or where it lies."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from fricomp.errors import RecordingError

from .recording import Recording

if TYPE_CHECKING:
    from pandas import DataFrame


def take_recording(given: Recording | DataFrame | str | os.PathLike[str]) -> Recording | Path:
    """The recording that was given, or the path of its file.

    Args:
        given: A recording, a data frame with its channels in SI units, or a path.

    Raises:
        RecordingError: It is something else, or the frame lacks a channel.
    """
    if isinstance(given, Recording):
        return given
    if isinstance(given, str | os.PathLike):
        return Path(given)
    if is_frame(given):
        return Recording.from_pandas(given)
    raise RecordingError(
        f"{type(given).__name__} is no recording: give a Recording, a data frame with the columns time, position and "
        "torque, or the path of a file"
    )


def is_frame(given: object) -> bool:
    """Whether it is a data frame of pandas, which need not be installed."""
    return hasattr(given, "columns") and hasattr(given, "iloc") and hasattr(given, "attrs")


def is_motion(given: object) -> bool:
    """Whether it is a data frame whose rows are a motion over time, and not points of friction."""
    return is_frame(given) and {"position", "torque"} <= set(given.columns)  # type: ignore[attr-defined]
