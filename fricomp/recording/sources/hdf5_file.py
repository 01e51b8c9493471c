"""HDF5 files, as those of ALOHA and robomimic and of MATLAB 7.3, read by h5py."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import MissingExtraError
from fricomp.recording.mapping import Source
from fricomp.recording.sources import own_process
from fricomp.recording.sources.columns import Contents, flatten_arrays
from fricomp.recording.sources.pandas_frame import find_frame, read_frame
from fricomp.untrusted import find_size_limit

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""With what a file begins, or what follows behind the 512 bytes that MATLAB writes first."""
_FLATTEST = 2
"""Dimensions of a data set from which on it is no channel: pictures of a camera have four."""
_OF_MATLAB = "MATLAB_class"
_NUMBERS = ("double", "single", "logical", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))
"""What MATLAB calls numbers; characters are numbers as well, and no channel."""


def read_hdf5(path: Path, source: Source) -> Contents:
    """Read the data sets of a HDF5 file: groups are named with dots, attributes that are one number or word as well.

    Raises:
        MissingExtraError: h5py is not installed.
        RecordingError: The file is damaged, or unpacks into more than any recording has.
    """
    if find_spec("h5py") is None:
        raise MissingExtraError("h5py", "convert")
    return own_process.read_in_process(__name__, path, "HDF5")


def is_hdf5(path: Path) -> bool:
    """Whether a file is one by its first bytes; one of MATLAB 7.3 has a block of its own before them."""
    with path.open("rb") as stream:
        if stream.read(len(SIGNATURE)) == SIGNATURE:
            return True
        stream.seek(512)
        return stream.read(len(SIGNATURE)) == SIGNATURE


def write_variables(path: str) -> None:
    """In the child: write all columns and words to the standard output."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            arrays, words = _collect(file, find_size_limit(Path(path)))
    except Exception as error:  # the parser raises whatever damaged bytes make it stumble over
        own_process.refuse(f"is no HDF5 file: {error}")
    own_process.write_contents(flatten_arrays(arrays), words)


def _collect(file: Any, limit: int) -> tuple[dict[str, Any], dict[str, list[str]]]:
    """Arrays and words of a file by their names; links out of it are not followed."""
    import h5py

    arrays, words, total = dict[str, Any](), dict[str, list[str]](), 0
    frames: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        nonlocal total
        called = name.replace("/", ".")
        if name.startswith("#") or any(name.startswith(f"{one}/") for one in frames):
            return  # where MATLAB keeps what its cells refer to, or what a frame consists of
        if isinstance(item, h5py.Group) and find_frame(item):
            frames[name] = item
            return
        _take_attributes(called, item.attrs, arrays, words)
        if not isinstance(item, h5py.Dataset) or item.ndim > _FLATTEST or item.size is None:
            return
        of_matlab = item.attrs.get(_OF_MATLAB, b"").decode() if _OF_MATLAB in item.attrs else ""
        if of_matlab and of_matlab not in _NUMBERS:
            return
        total += item.size * max(item.dtype.itemsize, 1)
        if total > limit:
            own_process.refuse(f"unpacks into more than {limit} bytes: it is damaged, or no recording")
        _take_data(called, item, arrays, is_transposed=bool(of_matlab))

    _take_attributes("", file.attrs, arrays, words)
    file.visititems(take)
    if total + sum(map(_measure, frames.values())) > limit:
        own_process.refuse(f"unpacks into more than {limit} bytes: it is damaged, or no recording")
    for name, item in frames.items():
        before = f"{name.replace('/', '.')}." if len(frames) > 1 else ""
        arrays |= {f"{before}{column}": values for column, values in read_frame(item).items()}
    return arrays, words


def _measure(group: Any) -> int:
    """Bytes that the data sets of a group unpack into."""
    return sum(getattr(item, "nbytes", 0) for key, item in group.items() if not key.startswith("_"))


def _take_data(name: str, item: Any, arrays: dict[str, Any], *, is_transposed: bool) -> None:
    """The numbers of a data set, of structures each field; texts as such, which may be names of its columns."""
    import h5py

    if h5py.check_string_dtype(item.dtype) is not None:
        arrays[name] = np.array(item.asstr()[...].tolist(), dtype=np.str_)
    elif item.dtype.names:
        arrays.update({f"{name}.{field}": item[field] for field in item.dtype.names})
    elif item.dtype.kind in "buif":
        arrays[name] = item[...].T if is_transposed else item[...]


def _take_attributes(name: str, attributes: Any, arrays: dict[str, Any], words: dict[str, list[str]]) -> None:
    """What stands beside a data set or a group: `dt`, `fps`, `units`."""
    for key, value in attributes.items():
        called = f"{name}.{key}".lstrip(".")
        if isinstance(value, str):
            words[called] = [value]
        elif np.ndim(value) == 0 and np.asarray(value).dtype.kind in "uif":
            arrays[called] = np.asarray(value)
