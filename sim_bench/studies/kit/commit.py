"""At which commit a figure was measured: a figure belongs to that commit, and later ones do not make it false."""

import subprocess
from datetime import date
from functools import cache
from pathlib import Path

from fricomp import version


@cache
def find_commit(folder: Path | None = None) -> str:
    """The commit of the source that runs, `with changes` where files differ from it.

    Args:
        folder: Of the source; by default that of the imported package.

    Returns:
        Such as `4962d2c` or `4962d2c with changes`; `release 0.1.0` where the source is no checkout.
    """
    place = folder or Path(version.__file__).resolve().parents[1]
    try:
        commit = _ask_git(place, "rev-parse", "--short", "HEAD")
        changed = _ask_git(place, "status", "--porcelain", "--untracked-files=no")
    except (OSError, subprocess.CalledProcessError):
        return f"release {version.__version__}"
    return f"{commit} with changes" if changed else commit


def format_measured(day: date, commit: str) -> str:
    """The sentence that tells of which day and commit a table is."""
    return f"Measured on {day.isoformat()} at commit {commit}."


def _ask_git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=True)
    return done.stdout.strip()
