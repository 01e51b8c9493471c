"""Text and sizes from files that anybody may have made: what would exhaust a parser is an error like any other."""

import tomllib
from pathlib import Path
from typing import Any, TypeVar, overload

import msgspec

_T = TypeVar("_T")

_LEAST_LIMIT = 2**30
"""Content that every file may have once it is unpacked [bytes]: an hour of twenty channels at 1 kHz is half of it."""
_LARGEST_RATIO = 200
"""Largest ratio of content to file: measured numbers compress to a third at best, constant channels to a hundredth."""


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


def parse_toml(text: str) -> dict[str, Any]:
    """The table in a text of TOML.

    Raises:
        tomllib.TOMLDecodeError: It is no TOML, is nested more deeply than anything that is meant, or has a number of
            thousands of digits.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("it is nested too deeply") from None
    except ValueError as error:
        raise tomllib.TOMLDecodeError(str(error)) from error


def find_size_limit(path: Path) -> int:
    """How large the content of a file may be once it is unpacked [bytes]; one that claims more is no recording."""
    return max(_LEAST_LIMIT, _LARGEST_RATIO * path.stat().st_size)
