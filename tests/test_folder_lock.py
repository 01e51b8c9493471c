"""One process writes a folder: a second one is told who does, and a dead one holds nothing."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from fricomp.errors import OutputError
from fricomp.folder_lock import LOCK_FILE, FolderLock

_HOLD = (
    "import sys, time; from pathlib import Path; from fricomp.folder_lock import FolderLock\n"
    "lock = FolderLock.take(Path(sys.argv[1])); lock.note('a calibration')\n"
    "print('held', flush=True); sys.stdin.read()"
)


@pytest.fixture
def holder(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that holds the lock on the folder until its input ends."""
    command = [sys.executable, "-c", _HOLD, str(tmp_path)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    with process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_a_second_process_is_told_who_holds_the_folder(holder: subprocess.Popen[str], tmp_path: Path) -> None:
    said = rf"is being written by process {holder.pid} since 2\d{{3}}-.*\(-c .*\): wait for it, end it, or choose"
    with pytest.raises(OutputError, match=said):
        FolderLock.take(tmp_path)
    assert (tmp_path / LOCK_FILE).exists()


def test_a_process_that_ends_leaves_nothing(holder: subprocess.Popen[str], tmp_path: Path) -> None:
    holder.communicate("")
    assert list(tmp_path.iterdir()) == []


def test_the_lock_of_a_killed_process_is_taken_over(holder: subprocess.Popen[str], tmp_path: Path) -> None:
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    with FolderLock.take(tmp_path) as lock:
        assert lock.left is not None
        assert (lock.left.pid, lock.left.writes) == (holder.pid, "a calibration")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"\xff\x00", b"[" * 4096, b'{"pid": "me"}'])
def test_a_lock_file_of_anything_locks_nothing(content: bytes, tmp_path: Path) -> None:
    (tmp_path / LOCK_FILE).write_bytes(content)
    with FolderLock.take(tmp_path) as lock:
        assert lock.left is None


def test_a_process_gets_its_own_lock_again_and_lets_it_go_with_the_last_reference(tmp_path: Path) -> None:
    first = FolderLock.take(tmp_path)
    assert FolderLock.take(tmp_path / ".") is first
    del first
    assert not (tmp_path / LOCK_FILE).exists()


def test_results_that_are_abandoned_are_known_as_unfinished(tmp_path: Path) -> None:
    lock = FolderLock.take(tmp_path)
    lock.note("an identification")
    lock.abandon()
    with FolderLock.take(tmp_path) as again:
        assert again.left is not None
        assert again.left.writes == "an identification"


def test_a_link_in_the_place_of_the_lock_is_not_followed(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.write_text("of somebody else")
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / LOCK_FILE).symlink_to(other)
    with pytest.raises(OutputError, match="cannot lock"):
        FolderLock.take(folder)
    assert other.read_text() == "of somebody else"


def test_a_file_system_without_locks_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr("fricomp.folder_lock.fcntl.flock", none)
    with pytest.raises(OutputError, match=r"cannot lock .*: No locks available; choose an --out .* takes locks"):
        FolderLock.take(tmp_path)
