"""Which module reads which format."""

import codecs
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from fricomp.errors import FricompError, RecordingError
from fricomp.recording.mapping import Column, Format, Source
from fricomp.recording.sources.array import read_binary, read_json, read_mat, read_npy, read_npz
from fricomp.recording.sources.can_frames import SUFFIXES_OF_FRAMES, explain_frames
from fricomp.recording.sources.columns import Columns, Contents
from fricomp.recording.sources.hdf5_file import read_hdf5
from fricomp.recording.sources.robot_log import read_mcap, read_rosbag
from fricomp.recording.sources.table import read_table, refuse_data_set
from fricomp.recording.sources.text import read_text
from fricomp.untrusted import limit_memory

_LONGEST_REASON = 300  # characters of a foreign error that are told
_READERS: dict[Format, Callable[[Path, Source], Columns]] = {
    "mat": read_mat,
    "npz": read_npz,
    "npy": read_npy,
    "binary": read_binary,
    "mcap": read_mcap,
    "rosbag2": read_rosbag,
}
_READERS_OF_WORDS: dict[Format, Callable[[Path, Source], Contents]] = {
    "json": read_json,
    "parquet": read_table,
    "hdf5": read_hdf5,
}
SUFFIXES: dict[str, Format] = {
    ".csv": "text",
    ".txt": "text",
    ".dat": "text",
    ".tsv": "text",
    ".mat": "mat",
    ".npz": "npz",
    ".npy": "npy",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".hdf": "hdf5",
    ".json": "json",
    ".jsonl": "json",
    ".ndjson": "json",
    ".bin": "binary",
    ".mcap": "mcap",
    ".db3": "rosbag2",
    ".bag": "rosbag2",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".feather": "parquet",
    ".arrow": "parquet",
    ".ipc": "parquet",
}
"""Formats by the suffixes of files."""
_ELSEWHERE = {
    ".xlsx": "a spreadsheet", ".xls": "a spreadsheet", ".ods": "a spreadsheet",
    ".db": "a data base", ".sqlite": "a data base", ".sqlite3": "a data base",
    ".pkl": "a pickle, which runs code", ".pickle": "a pickle, which runs code",
    ".tdms": "a LabVIEW TDMS", ".ulg": "a PX4 log", ".mf4": "a measurement of a vehicle", ".fig": "a figure",
}  # fmt: skip
"""Formats that the program which writes them saves as CSV as well."""
_UNPACKED_BY = {
    ".gz": "gunzip -k",
    ".zip": "unzip",
    ".bz2": "bunzip2 -k",
    ".xz": "unxz -k",
    ".zst": "unzstd",
    ".7z": "7z x",
}
_TEXT_SAMPLE = 4096
"""Bytes of a file by which text is told from anything else."""


def read_columns(path: Path, source: Source, keys: Collection[Column], *, skip_bad_rows: bool = False) -> Columns:
    """Read a foreign file.

    Args:
        path: File, or the folder of a rosbag2.
        source: How to read it.
        keys: Columns that are wanted; a reader may leave others out.
        skip_bad_rows: Give NaN where a text cell is no number, instead of an error.

    Raises:
        RecordingError: The file is missing, damaged or of a kind nobody here reads.
        MissingExtraError: The package that reads it is not installed.
    """
    return read_contents(path, source, keys, skip_bad_rows=skip_bad_rows).columns


def read_contents(
    path: Path, source: Source, keys: Collection[Column] = (), *, skip_bad_rows: bool = False
) -> Contents:
    """Read a foreign file with its words, of formats that tell words from numbers.

    Args:
        path: As for `read_columns`.
        source: As for `read_columns`.
        keys: As for `read_columns`.
        skip_bad_rows: As for `read_columns`.

    Raises:
        RecordingError: As for `read_columns`.
        MissingExtraError: As for `read_columns`.
    """
    if not path.exists():
        raise RecordingError(f"no source at {path}: check the path")
    kind = source.format or _guess_format(path)
    with refuse_damage(path, kind):
        if kind == "text":
            return Contents(read_text(path, source, keys, skip_bad_rows=skip_bad_rows), {})
        if kind in _READERS_OF_WORDS:
            return _READERS_OF_WORDS[kind](path, source)
        return Contents(_READERS[kind](path, source), {})


@contextmanager
def refuse_damage(path: Path, kind: Format) -> Iterator[None]:
    """What a reader of this format stumbles over is one error.

    Raises:
        RecordingError: In place of whatever else is raised.
    """
    try:
        with limit_memory(path):
            yield
    except FricompError:
        raise
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror or error}") from error
    except MemoryError as error:
        raise RecordingError(
            f"{path} claims more content than there is memory: it is damaged, or no recording"
        ) from error
    except Exception as error:  # a foreign parser raises whatever damaged bytes make it stumble over
        what = str(error)[:_LONGEST_REASON] or type(error).__name__
        raise RecordingError(f"{path} is damaged, or no {kind} that can be read: {what}") from error


def _guess_format(path: Path) -> Format:
    if path.is_dir():
        refuse_data_set(path)
        if not (path / "metadata.yaml").is_file():
            raise RecordingError(
                f"{path} is a folder, and no bag (which has a metadata.yaml): give the log inside of it"
            )
        return "rosbag2"
    if path.suffix.lower() not in SUFFIXES:
        if is_text(path):
            return "text"
        known = ", ".join(("text", *_READERS, *_READERS_OF_WORDS))
        raise RecordingError(f"{path.name}: unknown suffix; name the format in the mapping: {known}")
    return SUFFIXES[path.suffix.lower()]


def is_text(path: Path) -> bool:
    """Whether a file is read as a table of text: its suffix is one of text, or is not known and the file holds text.

    Raises:
        RecordingError: It is of a format that is not read, but saved as CSV by the program that wrote it.
    """
    suffix = path.suffix.lower()
    if suffix in SUFFIXES:
        return SUFFIXES[suffix] == "text"
    if suffix in _ELSEWHERE and not (suffix == ".xls" and path.is_file() and _begins_page(path)):
        raise RecordingError(
            f"{path} is {_ELSEWHERE[suffix]}, which is not read here: save it as CSV or Parquet there, or as MAT "
            "or NPZ, with a column each for time, position and torque"
        )
    if suffix in SUFFIXES_OF_FRAMES:
        raise RecordingError(explain_frames(path, converted=True))
    if suffix in _UNPACKED_BY:
        raise RecordingError(
            f"{path} is compressed: unpack it by '{_UNPACKED_BY[suffix]} {path}', and give the log that was in it"
        )
    if not path.is_file():
        return False
    return _holds_text(path)


def _begins_page(path: Path) -> bool:
    """Whether a file is a page or XML, as programs call spreadsheets that they write in these forms."""
    with path.open("rb") as stream:
        return stream.read(_TEXT_SAMPLE).lstrip(codecs.BOM_UTF8).lstrip().startswith(b"<")


def _holds_text(path: Path) -> bool:
    with path.open("rb") as stream:
        start = stream.read(_TEXT_SAMPLE)
    return b"\0" not in start and any(byte in b"0123456789" for byte in start)
