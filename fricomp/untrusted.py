"""Text and sizes from files that anybody may have made: what would exhaust a parser is an error like any other."""

import errno
import os
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, overload

import msgspec
from msgspec.inspect import UnionType, type_info

from fricomp.errors import RecordingError

if sys.platform == "linux":
    import resource

_T = TypeVar("_T")

_LIMITS = resource.getrlimit(resource.RLIMIT_DATA) if sys.platform == "linux" else (-1, -1)
"""Of this process as it began [bytes]."""

_LEAST_LIMIT = 2**30
"""Content that every file may have once it is unpacked [bytes]: an hour of twenty channels at 1 kHz is half of it."""
_LARGEST_RATIO = 200
"""Largest ratio of content to file: measured numbers compress to a third at best, constant channels to a hundredth."""
_LARGEST_WHOLE = 2**26
"""Size of a file that is read as one piece, such as a configuration, a model or a record [bytes]: none has a tenth,
networks of a thousand joints included."""
_ENDLESS_KEY = re.compile(r"""(?<![\w.-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){100}""")
"""A key of TOML of more parts than any: the parser's time and memory go with their square."""
_CELLS = 2**24
"""Cells that every table may have; more where at least one of 200 is filled."""
_COPIES = 4
"""Memory that reading may take, over the largest content: what was read is there as objects and as arrays."""


@overload
def parse_json(data: bytes | str) -> Any: ...
@overload
def parse_json(data: bytes | str, kind: type[_T]) -> _T: ...
def parse_json(data: bytes | str, kind: Any = Any) -> Any:
    """The value in a text of JSON, of this kind.

    Raises:
        msgspec.ValidationError: It is of another kind.
        msgspec.DecodeError: It is no JSON, or is nested more deeply than anything that is meant.
    """
    try:
        return msgspec.json.decode(data, type=kind)
    except RecursionError:
        raise msgspec.DecodeError("it is nested too deeply") from None
    except ValueError as error:  # no text in UTF-8, or a number of thousands of digits
        raise msgspec.DecodeError(str(error)) from error


def convert_table(table: Any, kind: type[_T]) -> _T:
    """What stands in a table, as a value of this kind.

    Raises:
        msgspec.ValidationError: A key or a value is none that the kind has; the message lists those there are.
    """
    try:
        return msgspec.convert(table, kind)
    except msgspec.ValidationError as error:
        said = str(error)
        valid = ", ".join(_list_valid(said, kind))
        raise msgspec.ValidationError(f"{said.replace('`', '')}{'; valid are ' if valid else ''}{valid}") from error


_STEP = re.compile(r"\.(\w+)|\[[^\]]*\]")
"""A step of the path in a message of msgspec: to a field, or to an entry of a list or of a table."""


def _list_valid(said: str, kind: type) -> list[str]:
    """Keys or values that could stand where a message of msgspec finds one that could not."""
    here = list(_flatten([type_info(kind)]))
    for step in _STEP.finditer(said.partition(" - at `$")[2].rstrip("`")):
        here = list(_flatten(inner for one in here for inner in _enter(one, step[1])))
    if "unknown field" in said:
        return [field.encode_name for one in here for field in getattr(one, "fields", ())]
    if "enum value" in said:
        return [repr(value) for one in here for value in getattr(one, "values", ())]
    return []


def _flatten(types: Iterable[Any]) -> Iterator[Any]:
    for one in types:
        yield from one.types if isinstance(one, UnionType) else (one,)


def _enter(kind: Any, field: str | None) -> list[Any]:
    """The kinds of a field, or of the entries of a list or a table."""
    if field is not None:
        return [one.type for one in getattr(kind, "fields", ()) if one.encode_name == field]
    inner = [getattr(kind, name, None) for name in ("item_type", "value_type")]
    return [one for one in inner if one is not None] + list(getattr(kind, "item_types", ()))


def parse_toml(text: str) -> dict[str, Any]:
    """The table in a text of TOML.

    Raises:
        tomllib.TOMLDecodeError: It is no TOML, is nested more deeply than anything that is meant, or has a number of
            thousands of digits.
    """
    if _ENDLESS_KEY.search(text):
        raise tomllib.TOMLDecodeError("it is nested too deeply")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("it is nested too deeply") from None
    except ValueError as error:
        raise tomllib.TOMLDecodeError(str(error)) from error


def read_whole(path: str | os.PathLike[str]) -> bytes:
    """The bytes of a small file: a configuration, a model, a mapping, a record. What has no end is not waited for.

    Raises:
        OSError: It cannot be read, is larger than any of these, or its path has a null character.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(_LARGEST_WHOLE + 1)
    except ValueError:
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL), repr(str(path))) from None
    if len(data) > _LARGEST_WHOLE:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
    return data


def find_place(path: str | os.PathLike[str]) -> Path:
    """The absolute path without links, also of one that is not there; links in a circle stay as they are."""
    return Path(os.path.realpath(path))


def find_size_limit(path: Path) -> int:
    """How large the content of a file, or a bag, may be once it is unpacked [bytes]; one that claims more is no log."""
    files = [one for one in path.iterdir() if one.is_file()] if path.is_dir() else [path]
    return max(_LEAST_LIMIT, _LARGEST_RATIO * sum(file.stat().st_size for file in files))


def require_filled(n_rows: int, n_columns: int, n_filled: int) -> None:
    """Refuse a table that is large for its empty cells alone, before memory is taken for it.

    Raises:
        RecordingError: It is one: rows that each have columns, or lengths, of their own.
    """
    if n_rows * n_columns > max(_CELLS, _LARGEST_RATIO * n_filled):
        raise RecordingError(
            f"{n_rows} rows would have {n_columns} columns, and hold {n_filled} values in all: that is no log, or one "
            "whose rows each have names of their own; write one name a quantity"
        )


@contextmanager
def limit_memory(path: Path) -> Iterator[None]:
    """Let what reads this file take a few times its largest content and no more than is free; else it is out of memory.

    Other systems than Linux count memory in other ways, and have no such limit.
    """
    if sys.platform != "linux":
        yield
        return
    room = min(_COPIES * find_size_limit(path), _find_free_memory())
    taken = int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
    wanted = [taken + room, *(limit for limit in _LIMITS if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_DATA, (min(wanted), _LIMITS[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, _LIMITS)


def _find_free_memory() -> int:
    lines = Path("/proc/meminfo").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
