"""Compilation of the plant's inner loops with numba; the only module of the generator that imports it."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from fricomp.errors import MissingExtraError

_Function = TypeVar("_Function", bound="Callable[..., Any]")

# One row of a structured array; numba knows its fields, the type checker does not.
Record = Any


def compile_cached(function: _Function) -> _Function:
    """`function` compiled to machine code, cached on disk, without holding the interpreter lock.

    Raises:
        MissingExtraError: numba is not installed.
    """
    try:
        import numba
    except ImportError as error:  # pragma: no cover - depends on the installation
        raise MissingExtraError("numba", "sim") from error
    return cast("_Function", numba.njit(cache=True, nogil=True, error_model="numpy")(function))
