"""What a bag may hold that its reader would work on without end: queries in a data base, endless definitions."""

import re
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

from fricomp.errors import RecordingError
from fricomp.untrusted import find_size_limit

_LENGTH = re.compile(r"\[\s*(\d+)\s*\]|<[^<>]*,\s*(\d+)\s*>")
"""A fixed length in a definition of ROS, or in one of IDL."""
_LONGEST_ARRAY = 10_000
"""Entries of a fixed array: the reader writes a line of its program for each; those of ROS have 36."""
_PACKED = b"\x28\xb5\x2f\xfd"
"""First bytes of a file that is packed by zstd."""
_COMPUTED = re.compile(r"\bAS\b|^CREATE (?!TABLE|INDEX|UNIQUE INDEX)", re.IGNORECASE)
"""What makes a view, a column that is computed, a trigger or a table of a plug-in."""
_REPEATED = "SELECT count(*) > count(DISTINCT id) FROM topics"


def require_plain_files(path: Path) -> None:
    """Refuse a bag whose tables are computed as they are read, such as views, or multiply its messages by topics.

    Refuse one, too, that unpacks without end, which its reader does on the disk.

    Args:
        path: A file, or the folder of a bag; files that are neither a data base nor packed are left to the reader.

    Raises:
        RecordingError: It is such a bag.
    """
    for file in sorted(one for one in path.iterdir() if one.is_file()) if path.is_dir() else [path]:
        _require_end(file)
        try:
            with closing(sqlite3.connect(f"{file.absolute().as_uri()}?immutable=1&mode=ro", uri=True)) as base:
                made = [sql for (sql,) in base.execute("SELECT sql FROM sqlite_master") if sql]
                is_odd = any(map(_COMPUTED.search, made)) or base.execute(_REPEATED).fetchone()[0]
        except (sqlite3.Error, ValueError):
            continue
        if is_odd:
            raise RecordingError(
                f"{file} computes its tables, or has topics twice: it is no bag that a robot has written"
            )


def _require_end(file: Path) -> None:
    with file.open("rb") as stream:
        if stream.read(len(_PACKED)) != _PACKED:
            return
        from zstandard import ZstdDecompressor

        stream.seek(0)
        unpacked = ZstdDecompressor().stream_reader(stream, read_across_frames=True)
        limit, content = find_size_limit(file), 0
        while step := len(unpacked.read(2**20)):
            content += step
            if content > limit:
                raise RecordingError(f"{file} unpacks into more than {limit} bytes: it is damaged, or no bag")


def require_small_arrays(path: Path, definitions: Iterable[str]) -> None:
    """Refuse a bag with message definitions of arrays of any length.

    Raises:
        RecordingError: One is longer than any message is.
    """
    for definition in set(definitions):
        lengths = [int(first or second) for first, second in _LENGTH.findall(definition)]
        if sum(lengths) > _LONGEST_ARRAY:
            raise RecordingError(
                f"{path} defines a message with {max(lengths)} fixed entries: it is no log that is read"
            )
