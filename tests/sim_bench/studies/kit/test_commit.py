"""A figure carries the commit that it was measured at."""

import subprocess
from datetime import date
from pathlib import Path

from fricomp.sim_bench.studies.kit.commit import find_commit, format_measured


def _ask_git(folder: Path, *arguments: str) -> str:
    identity = ("-c", "user.name=test", "-c", "user.email=test@example.org")
    done = subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def test_the_commit_is_that_of_the_folder_and_tells_of_changes(tmp_path: Path) -> None:
    (tmp_path / "code.py").write_text("a = 1\n")
    for call in (("init", "-q"), ("add", "."), ("commit", "-q", "-m", "code")):
        _ask_git(tmp_path, *call)
    commit = _ask_git(tmp_path, "rev-parse", "--short", "HEAD")
    find_commit.cache_clear()
    assert find_commit(tmp_path) == commit
    (tmp_path / "code.py").write_text("a = 2\n")
    find_commit.cache_clear()
    assert find_commit(tmp_path) == f"{commit} with changes"
    assert format_measured(date(2026, 11, 25), commit) == f"Measured on 2026-11-25 at commit {commit}."


def test_without_a_checkout_the_release_is_told(tmp_path: Path) -> None:
    assert find_commit(tmp_path).startswith("release ")
