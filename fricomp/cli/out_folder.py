"""The folder of `--out`: refused before any work where it cannot be one, made where it is not there."""

from __future__ import annotations

from pathlib import Path

from fricomp.errors import ParameterError

__all__ = ["make_folder", "require_folder"]


def require_folder(folder: Path) -> None:
    """Refuse a path below which nothing can be written, before any work is done.

    Raises:
        ParameterError: It is a file, or lies below one.
    """
    for place in (folder, *folder.parents):
        if place.exists():
            if not place.is_dir():
                raise ParameterError(f"cannot make the folder {folder}: {place} is a file; choose another --out")
            return


def make_folder(folder: Path) -> None:
    """Make a folder with those above it, if it is not there.

    Raises:
        ParameterError: It cannot be made.
    """
    require_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ParameterError(
            f"cannot make the folder {folder}: {error.strerror or error}; choose another --out"
        ) from error
