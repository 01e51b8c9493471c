"""Arrays in files: MATLAB, numpy, JSON and raw binary."""

import math
import struct
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import msgspec
import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.sources.columns import Columns, Contents, flatten_arrays
from fricomp.recording.sources.hdf5_file import is_hdf5, read_hdf5
from fricomp.recording.sources.json_table import tabulate
from fricomp.recording.sources.mat_file import read_variables
from fricomp.untrusted import find_size_limit, parse_json

_MAT_HEADER, _MAT_COMPRESSED, _MAT_STEP = 128, 15, 2**20  # of the format: header, kind of an element; a step
_DAMAGED = (ValueError, AttributeError, EOFError, zlib.error)  # what numpy raises on a broken file
_OWN = "fricomp."
"""With what the schema of a document begins that this package wrote: a model, a diagnosis."""


def read_mat(path: Path, source: Source) -> Columns:
    """Read a MATLAB file; the fields of a structure are named with dots.

    Raises:
        MissingExtraError: scipy is not installed, or h5py, which reads version 7.3.
        RecordingError: The file is damaged.
    """
    if is_hdf5(path):
        return read_hdf5(path, source).columns
    try:
        _require_content(path, _measure_mat(path))
    except zlib.error as error:
        raise RecordingError(f"{path} is no MATLAB file: {error}") from error
    return read_variables(path)


def read_npz(path: Path, source: Source) -> Columns:
    """Read the arrays of a numpy archive; arrays of objects, which are pickled, are left out."""
    from zipfile import BadZipFile, ZipFile

    try:
        with ZipFile(path) as packed:
            _require_content(path, sum(member.file_size for member in packed.infolist()))
            plain = []
            for member in packed.infolist():
                with packed.open(member) as stream:
                    if _require_array(path, stream, member.file_size):
                        plain.append(member.filename.removesuffix(".npy"))
        if not plain:
            raise RecordingError(
                f"{path} holds objects of Python alone, which could run code: save numbers, as arrays t, "
                "q and tau of float"
            )
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            return flatten_arrays(_list_fields({name: archive[name] for name in archive.files if name in plain}))
    except (*_DAMAGED, BadZipFile) as error:
        raise RecordingError(f"{path} is no numpy archive of numbers: {error}") from error


def read_npy(path: Path, source: Source) -> Columns:
    """Read one numpy array of shape (n_samples, n_columns); pickled objects are refused."""
    try:
        with path.open("rb") as stream:
            _require_array(path, stream, path.stat().st_size)
        array = np.load(path, allow_pickle=False)
    except _DAMAGED as error:
        raise RecordingError(f"{path} is no numpy array of numbers: {error}") from error
    return flatten_arrays(_list_fields({"": array} if array.dtype.names else {"array": np.atleast_2d(array)}))


def _list_fields(arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Arrays by name, of structured ones each field as `name.field`."""
    flat: dict[str, Any] = {}
    for name, array in arrays.items():
        fields = {f"{name}.{field}".lstrip("."): array[field] for field in array.dtype.names or ()}
        flat |= _list_fields(fields) if fields else {name: array}
    return flat


def _require_array(path: Path, stream: IO[bytes], size: int) -> bool:
    """Refuse an array whose header claims more than there are bytes, before memory is taken for it.

    Returns:
        Whether it holds no objects.
    """
    version = np.lib.format.read_magic(stream)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    if dtype.hasobject:
        return False
    if math.prod(shape) * max(dtype.itemsize, 1) > size:
        raise RecordingError(f"{path} claims an array of shape {shape}, and has {size} bytes: it is damaged")
    return True


def _require_content(path: Path, content: int) -> None:
    """Refuse a file that unpacks into more than any recording has, before it is unpacked."""
    if content > find_size_limit(path):
        raise RecordingError(
            f"{path} of {path.stat().st_size} bytes unpacks into more than {find_size_limit(path)} bytes: it is "
            "damaged, or no recording"
        )


def _measure_mat(path: Path) -> int:
    """Bytes of the packed variables of a MATLAB file once they are unpacked, counted up to the limit."""
    content, limit = 0, find_size_limit(path)
    data = path.read_bytes()
    order = "<" if data[126:128] == b"IM" else ">"
    position = _MAT_HEADER
    while position + 8 <= len(data) and content <= limit:
        kind, size = struct.unpack_from(f"{order}II", data, position)
        if kind == _MAT_COMPRESSED:
            unpacked = zlib.decompressobj()
            packed = data[position + 8 : position + 8 + size]
            while packed and content <= limit:
                content += len(unpacked.decompress(packed, _MAT_STEP))
                packed = unpacked.unconsumed_tail
        position += 8 + size
    return content


def read_json(path: Path, source: Source) -> Contents:
    """Read JSON: rows at `source.records` or where the only ones are, an object of lists, names beside rows, series of
    pairs of time and value; or a row a line.
    """
    content: Any
    try:
        content = _parse(path)
        for key in source.records.split(".") if source.records else ():
            content = content[key]
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} is no JSON: {error}") from error
    except (KeyError, TypeError) as error:
        raise RecordingError(f"{path} has no records at {source.records!r}") from error
    said = content.get("schema") if isinstance(content, dict) else None
    if isinstance(said, str) and said.startswith(_OWN):
        kind = said.removeprefix(_OWN).partition("/")[0].replace("_", " ")
        raise RecordingError(f"{path} is a {kind} that fricomp wrote, and no recording: give the log of a joint")
    table = tabulate(content)
    if table is None:
        raise RecordingError(f"{path} holds neither rows nor columns at {source.records or 'its top level'!r}")
    return table


def _parse(path: Path) -> Any:
    """The content of a file, or the rows of one that has an object a line, whatever its name ends in."""
    if path.suffix.lower() in (".jsonl", ".ndjson"):
        return _parse_lines(path)
    try:
        return parse_json(path.read_bytes())
    except msgspec.DecodeError:
        with suppress(msgspec.DecodeError):
            rows = _parse_lines(path)
            if len(rows) > 1 and all(isinstance(row, dict) for row in rows):
                return rows
        raise


def _parse_lines(path: Path) -> list[Any]:
    """The rows of a file that has a JSON object a line; an unfinished last line is the trace of a killed writer."""
    lines = [line for line in path.read_bytes().splitlines() if line.strip()]
    rows = [parse_json(line) for line in lines[:-1]]
    try:
        return [*rows, *map(parse_json, lines[-1:])]
    except msgspec.DecodeError:
        return rows


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
