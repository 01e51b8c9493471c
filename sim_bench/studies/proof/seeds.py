"""Seeds of cases: development ones for anybody, scored ones that follow from the diagnosis that is scored.

A scored seed is the hash of the tree hash of the diagnosis folder, the number of the run and the number of the case.
Nobody can look at those cases before the diagnosis is committed, and a change of the diagnosis changes them.
"""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Iterator
from itertools import count
from pathlib import Path

from fricomp.errors import DiagnosisError

__all__ = ["current_commit", "development_seeds", "diagnosis_tree", "folder_tree", "scored_seeds"]

_SCORED = 1 << 62  # set in every scored seed and in no development seed


def development_seeds(first: int = 0) -> Iterator[int]:
    """Seeds first, first + 1, … that the diagnosis may be developed on.

    Raises:
        DiagnosisError: `first` is negative or among the scored seeds.
    """
    if not 0 <= first < _SCORED // 2:
        raise DiagnosisError(f"development seeds start between 0 and {_SCORED // 2}, got {first}")
    return count(first)


def scored_seeds(tree: str, run: int) -> Iterator[int]:
    """Seeds of the scored run number `run` of the diagnosis with this tree hash; none is a development seed."""
    for index in count():
        digest = hashlib.sha256(f"{tree}:{run}:{index}".encode()).digest()
        yield _SCORED | int.from_bytes(digest[:7], "big")


def diagnosis_tree(repository: Path) -> str:
    """Git's tree hash of the committed diagnosis folder.

    Raises:
        DiagnosisError: There is no git repository, or the folder differs from what is committed.
    """
    return folder_tree(repository, "fricomp/diagnosis")


def folder_tree(repository: Path, folder: str) -> str:
    """Git's tree hash of a committed folder.

    Raises:
        DiagnosisError: There is no git repository, or the folder differs from what is committed.
    """
    changed = _git(repository, "status", "--porcelain", "--", folder)
    if changed:
        raise DiagnosisError(f"{folder} differs from what is committed, commit it before a scored run:\n{changed}")
    return _git(repository, "rev-parse", f"HEAD:{folder}")


def current_commit(repository: Path) -> str:
    """Hash of the commit that is checked out.

    Raises:
        DiagnosisError: There is no git repository.
    """
    return _git(repository, "rev-parse", "HEAD")


def _git(repository: Path, *arguments: str) -> str:
    try:
        done = subprocess.run(["git", "-C", str(repository), *arguments], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        detail = getattr(error, "stderr", "") or error
        raise DiagnosisError(f"a scored run needs the git repository of fricomp: {detail}") from error
    return done.stdout.strip()
