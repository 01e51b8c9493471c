"""Files that appear whole or not at all."""

import os
import platform
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from typing import Any

import msgspec

from fricomp.errors import FricompError, OutputError

_PART = re.compile(r"\.(?P<node>[\w-]+)\.(?P<pid>\d+)\.[0-9a-f]{8}\.part")
"""Ending of an unfinished file: the host and the process that write it, and a random number."""
_LONGEST_STEM = 100  # characters of a file's name in that of its unfinished one: a file system takes 255 bytes


@contextmanager
def whole_file(path: Path, error: type[FricompError] = OutputError) -> Iterator[Path]:
    """Give a path beside the wanted one to write to; move it into place only when all went well.

    The folder is made where it is not there. A link in the place of the file is replaced, not followed. What is
    written is on the disk before it is moved, so that a power cut leaves the old file or the new one.

    Args:
        path: Of the file.
        error: What is raised where the folder cannot be made or written, or the disk is full.

    Raises:
        FricompError: Of that kind.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as failure:
        raise error(f"cannot make the folder {path.parent}: {failure.strerror or failure}") from failure
    temporary = path.with_name(f".{path.name[:_LONGEST_STEM]}.{_node()}.{os.getpid()}.{token_hex(4)}.part")
    try:
        temporary.touch(exist_ok=False)
        yield temporary
        _sync(temporary)
        temporary.replace(path)
    except OSError as failure:
        _discard(temporary)
        raise error(f"cannot write {path}: {failure.strerror or failure}") from failure
    except BaseException:
        _discard(temporary)
        raise


def write_whole(path: Path, content: bytes | str, error: type[FricompError] = OutputError) -> None:
    """Write a file of these bytes, or of this text in UTF-8, whole or not at all.

    Args:
        path: Of the file.
        content: All of it.
        error: What is raised where it cannot be written.

    Raises:
        FricompError: Of that kind.
    """
    with whole_file(path, error) as part:
        part.write_bytes(content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content)


def write_json(path: Path, value: Any) -> None:
    """Write a value as JSON, as of `format_json`, whole or not at all.

    Raises:
        OutputError: It cannot be written.
    """
    write_whole(path, format_json(value) + "\n")


def format_json(value: Any) -> str:
    """A value as JSON; a number that is not finite is null, as JSON has none.

    Args:
        value: Mappings, sequences, dataclasses, msgspec structs, numbers, arrays, texts; anything else is its text.
    """
    return msgspec.json.format(msgspec.json.encode(value, enc_hook=_encode)).decode()


def _encode(value: Any) -> Any:
    """Arrays and numbers of numpy as Python's own, anything else as its text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def remove_abandoned_parts(folder: Path) -> None:
    """Remove the unfinished files in a folder whose writers were killed; those of a process that lives stay."""
    for path in folder.glob(".*.part"):
        found = _PART.search(path.name)
        if found is not None and found["node"] == _node() and not _is_alive(int(found["pid"])):
            _discard(path)


def _sync(path: Path) -> None:
    """Wait until a file is on the disk; a disk that is full may say so only here."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _discard(path: Path) -> None:
    with suppress(OSError):
        path.unlink(missing_ok=True)


def _node() -> str:
    """Name of this host, in letters that a file's name may have."""
    return re.sub(r"[^\w-]", "_", platform.node(), flags=re.ASCII)[:40] or "host"


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
