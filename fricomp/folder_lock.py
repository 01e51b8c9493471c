"""A lock on a folder of results, or on a single file: one process writes it at a time, and a second is told who does.

The lock is the operating system's (`flock`) on the file `.fricomp.lock`, which says who holds it. The system lifts it
when the process ends, however it ends, so that a lock is never stale: neither a process number that was given again
nor a clock matters. On NFS Linux takes it at the server, so that it holds between hosts. A single file, such as an
export, has a lock file of its own beside it, so that many may be written into one folder at once.
"""

from __future__ import annotations

import errno
import os
import platform
import shlex
import sys
import weakref
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import ClassVar, Self

import msgspec

from fricomp.errors import OutputError
from fricomp.untrusted import find_place

try:
    import fcntl
except ImportError:  # on a system without it nothing is locked
    fcntl = None  # type: ignore[assignment]

LOCK_FILE = ".fricomp.lock"

_LONGEST_COMMAND = 300  # characters of a command line that are told
_LONGEST_RECORD = 4096  # bytes of a lock file that are read
_LONGEST_STEM = 60  # characters of a file's name in that of its lock: a file system takes 255 bytes
_TAKEN = (errno.EWOULDBLOCK, errno.EAGAIN)


class LockRecord(msgspec.Struct, frozen=True):
    """What stands in a lock file.

    Attributes:
        pid: Process that holds the lock.
        host: Where it runs.
        command: How it was started.
        since: When it took the lock, local time.
        writes: What it writes into the folder, such as a calibration; empty until it is known that it may.
    """

    pid: int
    host: str
    command: str
    since: str
    writes: str = ""


class FolderLock:
    """The lock on a folder or a file, held until `release`, the end of the process, or of the last reference to it.

    A process that holds it already gets the same lock once more. See `take` and `take_file`.

    Attributes:
        left: What a process that was killed there has left in its lock file; None where none was.
    """

    _held: ClassVar[weakref.WeakValueDictionary[Path, FolderLock]] = weakref.WeakValueDictionary()

    def __init__(self, target: Path, lock_file: Path, descriptor: int, left: LockRecord | None) -> None:
        self.left, self._target, self._descriptor = left, target, descriptor
        self._finalizer = weakref.finalize(self, _release, lock_file, descriptor, os.getpid())

    @classmethod
    def take(cls, folder: Path) -> FolderLock:
        """Lock a folder that exists.

        Raises:
            OutputError: Another process holds the lock, or the file system takes none.
        """
        place = find_place(folder)
        return cls._take(place, place / LOCK_FILE)

    @classmethod
    def take_file(cls, path: Path) -> FolderLock:
        """Lock a single file, whose folder exists; other files there are left to others.

        Raises:
            OutputError: Another process holds its lock or that of its folder, or the file system takes none.
        """
        folder = find_place(path.parent)
        _require_unheld(folder)
        return cls._take(folder / path.name, folder / f".{path.name[:_LONGEST_STEM]}{LOCK_FILE}")

    @classmethod
    def _take(cls, target: Path, lock_file: Path) -> FolderLock:
        held = cls._held.get(lock_file)
        if held is not None and held._finalizer.alive:
            return held
        descriptor, left = _open_locked(lock_file, target)
        lock = cls(target, lock_file, descriptor, left)
        lock.note("")
        cls._held[lock_file] = lock
        return lock

    def note(self, writes: str) -> None:
        """Say in the lock file who holds it, and what is written."""
        command = shlex.join(sys.argv)[:_LONGEST_COMMAND]
        since = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
        record = LockRecord(os.getpid(), platform.node(), command, since, writes)
        try:
            os.ftruncate(self._descriptor, 0)
            os.pwrite(self._descriptor, msgspec.json.encode(record), 0)
        except OSError as error:
            raise _failure(self._target, error) from error

    def release(self) -> None:
        """Let others have it."""
        self._finalizer()

    def abandon(self) -> None:
        """Let others have it, and leave the lock file there: its results are unfinished."""
        if self._finalizer.detach() is not None:
            os.close(self._descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.release()


def _require_unheld(folder: Path) -> None:
    """Refuse a folder that another process holds as a whole.

    Raises:
        OutputError: It does; the message says who.
    """
    lock_file = folder / LOCK_FILE
    held = FolderLock._held.get(lock_file)
    if fcntl is None or (held is not None and held._finalizer.alive):
        return
    try:
        descriptor = os.open(lock_file, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return  # nobody has begun
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in _TAKEN:
            raise _failure(folder, error, _read(descriptor)) from error
    finally:
        os.close(descriptor)


def _open_locked(path: Path, target: Path) -> tuple[int, LockRecord | None]:
    """The open lock file of a target, locked, and what an earlier holder left in it."""
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        except OSError as error:
            raise _failure(target, error) from error
        try:
            if fcntl is not None:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_same(descriptor, path):
                return descriptor, _read(descriptor)
        except OSError as error:
            told = _failure(target, error, _read(descriptor) if error.errno in _TAKEN else None)
            os.close(descriptor)
            raise told from error
        os.close(descriptor)  # its holder has removed the file between both calls: take the new one


def _is_same(descriptor: int, path: Path) -> bool:
    """Whether the file that is open is the one that is there."""
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path, follow_symlinks=False))
    except FileNotFoundError:
        return False


def _read(descriptor: int) -> LockRecord | None:
    try:
        return msgspec.json.decode(os.pread(descriptor, _LONGEST_RECORD, 0), type=LockRecord)
    except (OSError, msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return None


def _failure(target: Path, error: OSError, holder: LockRecord | None = None) -> OutputError:
    if error.errno not in _TAKEN:
        return OutputError(
            f"cannot lock {target}: {error.strerror or error}; choose an --out that can be written, on a file system "
            "that takes locks"
        )
    if holder is None:
        return OutputError(f"another process is writing {target}: wait for it, or choose another --out")
    where = "" if holder.host == platform.node() else f" on {holder.host}"
    return OutputError(
        f"{target} is being written by process {holder.pid}{where} since {holder.since} ({holder.command}): wait for "
        "it, end it, or choose another --out"
    )


def _release(path: Path, descriptor: int, pid: int) -> None:
    """Remove the file while it is locked, so that nobody locks one that is about to go."""
    if os.getpid() != pid:
        return  # a child process that was forked: the lock is its parent's
    with suppress(OSError):
        path.unlink()
    with suppress(OSError):
        os.close(descriptor)
