"""Arrays in files: MATLAB, numpy, JSON and raw binary."""

import zlib
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.sources.columns import Columns, columns_of_records, flatten_arrays

_DAMAGED = (ValueError, AttributeError, EOFError, zlib.error)  # what numpy raises on a broken file


def read_mat(path: Path, source: Source) -> Columns:
    """Read a MATLAB file up to version 7; the fields of a structure are named with dots.

    Raises:
        MissingExtraError: scipy is not installed.
        RecordingError: The file is damaged, or of version 7.3.
    """
    try:
        from scipy.io import loadmat
    except ImportError as error:
        raise MissingExtraError("scipy", "convert") from error
    try:
        content = loadmat(path, simplify_cells=True)
    except NotImplementedError as error:
        raise RecordingError(f"{path} is a MATLAB 7.3 file: save it in MATLAB with save(..., '-v7')") from error
    except OSError:
        raise
    except Exception as error:  # the parser raises whatever damaged bytes make it stumble over
        raise RecordingError(f"{path} is no MATLAB file: {error}") from error
    return flatten_arrays(_flatten_structures({name: v for name, v in content.items() if not name.startswith("__")}))


def read_npz(path: Path, source: Source) -> Columns:
    """Read the arrays of a numpy archive; pickled objects are refused."""
    from zipfile import BadZipFile

    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            return flatten_arrays({name: archive[name] for name in archive.files})
    except (*_DAMAGED, BadZipFile) as error:
        raise RecordingError(f"{path} is no numpy archive of numbers: {error}") from error


def read_npy(path: Path, source: Source) -> Columns:
    """Read one numpy array of shape (n_samples, n_columns); pickled objects are refused."""
    try:
        array = np.load(path, allow_pickle=False)
    except _DAMAGED as error:
        raise RecordingError(f"{path} is no numpy array of numbers: {error}") from error
    if array.dtype.names:
        return flatten_arrays({name: array[name] for name in array.dtype.names})
    return flatten_arrays({"array": np.atleast_2d(array)})


def read_json(path: Path, source: Source) -> Columns:
    """Read JSON: a list of rows at `source.records`, or an object of lists."""
    try:
        content = msgspec.json.decode(path.read_bytes())
        for key in source.records.split(".") if source.records else ():
            content = content[key]
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} is no JSON: {error}") from error
    except (KeyError, TypeError) as error:
        raise RecordingError(f"{path} has no records at {source.records!r}") from error
    if isinstance(content, list):
        return columns_of_records(content)
    if isinstance(content, dict):
        return flatten_arrays(_flatten_structures(content))
    raise RecordingError(f"{path} holds neither rows nor columns at {source.records or 'its top level'!r}")


def read_binary(path: Path, source: Source) -> Columns:
    """Read rows of `source.columns` numbers of type `source.dtype` without any header."""
    values = np.fromfile(path, dtype=_number_format(source.dtype))
    if not values.size or values.size % source.columns or path.stat().st_size % values.itemsize:
        raise RecordingError(
            f"{path} has {path.stat().st_size} bytes: no whole number of rows of {source.columns} {source.dtype}"
        )
    return flatten_arrays({"array": values.reshape(-1, source.columns)})


def _number_format(name: str) -> np.dtype[Any]:
    try:
        dtype = np.dtype(name)
    except (TypeError, ValueError) as error:
        raise RecordingError(f"unknown number format {name!r}: write it as numpy does, '<f8'") from error
    if dtype.kind not in "buif":
        raise RecordingError(f"{name!r} is no format of one number: write one as numpy does, '<f8'")
    return dtype


def _flatten_structures(content: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in content.items():
        if isinstance(value, dict):
            flat.update(_flatten_structures(value, f"{prefix}{name}."))
        else:
            flat[f"{prefix}{name}"] = value
    return flat
