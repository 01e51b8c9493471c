"""Recordings as CSV: metadata in leading `# key: value` lines, then a header of channel names.

    # fricomp.recording/1
    # joint: "elbow"
    # torque_unit: "N·m"
    time,position,torque
    0.0,0.1,1.5

Values are JSON; a bare word is taken as text. Other lines that start with `#` are comments. A file
whose first line names the schema always ends its lines, so an unfinished last line there is
the trace of a writer that was killed: it is dropped, and the reader says so.
"""

import io
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording.finding import Finding
from fricomp.recording.metadata import RecordingMetadata, metadata_from_fields, metadata_to_fields
from fricomp.recording.number_rows import read_head, read_number_rows
from fricomp.recording.recording import CHANNELS, REQUIRED_CHANNELS, Recording
from fricomp.recording.runs import sort_rows
from fricomp.recording.stamps import with_row_rate
from fricomp.recording.validity import drop_bad_rows, mend_stamps
from fricomp.untrusted import parse_json
from fricomp.whole_file import write_whole

SCHEMA = "fricomp.recording/1"
_FAMILY = "fricomp.recording/"


class FileContent(NamedTuple):
    """A recording from a CSV file and what was wrong with the file itself."""

    recording: Recording
    findings: tuple[Finding, ...]


def format_preamble(metadata: RecordingMetadata, channels: Iterable[str]) -> str:
    """Return the comment lines and the header that open a CSV recording."""
    fields = metadata_to_fields(metadata)
    lines = [f"# {SCHEMA}", *(f"# {name}: {msgspec.json.encode(value).decode()}" for name, value in fields.items())]
    return "\n".join([*lines, ",".join(channels)]) + "\n"


def format_rows(recording: Recording, channels: Iterable[str]) -> str:
    """Return the samples as CSV lines; every number reads back to the same bits."""
    columns = [recording.channels[name].tolist() for name in channels]
    return "".join(",".join(map(repr, row)) + "\n" for row in zip(*columns, strict=True))


def write_csv(recording: Recording, path: Path) -> None:
    """Write a recording; the file appears whole or not at all.

    Raises:
        RecordingError: The folder cannot be written, or the disk is full.
    """
    rows = format_rows(recording, recording.channels)
    write_whole(path, format_preamble(recording.metadata, recording.channels) + rows, RecordingError)


def read_csv(path: Path, *, skip_bad_rows: bool = False, row_rate: float | None = None) -> FileContent:
    """Read a CSV recording.

    Args:
        path: File.
        skip_bad_rows: Leave out rows without a finite number in every column or with a time that does not advance.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.

    Raises:
        RecordingError: The file is no recording, holds something that is no number, or its
            samples cannot be used; the message names row, column and what to do.
    """
    fast = None if skip_bad_rows else _read_fast(path)
    if fast is not None:
        fields, columns = fast
        return _build_content(path, fields, with_row_rate(columns, row_rate), ())
    text = _read_text(path)
    fields, header, start = _split_preamble(text, path)
    names = _parse_header(header, path)
    body, findings = _drop_torn_line(text[start:], len(names), signed=text.startswith(f"# {_FAMILY}"))
    try:
        table = _parse_table(body, names, skip_bad_rows=skip_bad_rows)
        columns = with_row_rate(dict(zip(names, table.T, strict=True)), row_rate)
        if skip_bad_rows:
            columns, left_out = drop_bad_rows(columns)
            findings += left_out
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from error
    return _build_content(path, fields, columns, findings)


def _read_fast(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]] | None:
    """Metadata and columns of a large file that holds nothing but numbers; None where it must be read with care."""
    head = read_head(path)
    if head is None:
        return None
    text, before = head
    try:
        fields, header, start = _split_preamble(text, path)
        names = _parse_header(header, path)
    except RecordingError:  # which the careful way says of the whole file
        return None
    columns = read_number_rows(path, before + len(text[:start].encode()), names)
    return None if columns is None else (fields, columns)


def _build_content(
    path: Path, fields: dict[str, Any], columns: dict[str, NDArray[np.float64]], findings: tuple[Finding, ...]
) -> FileContent:
    try:
        columns, late = sort_rows(columns)
        columns, repeated = mend_stamps(columns)
        return FileContent(Recording.from_channels(columns, metadata_from_fields(fields)), findings + late + repeated)
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from error


def _read_text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise RecordingError(f"{path} is no text file: convert it with 'fricomp convert'") from error


def _split_preamble(text: str, path: Path) -> tuple[dict[str, Any], str, int]:
    """Return the metadata fields, the header line and where the rows start."""
    fields: dict[str, Any] = {}
    start = 0
    for line in _lines(text):
        start += len(line)
        content = line.strip()
        if not content:
            continue
        if not content.startswith("#"):
            return fields, content, start
        _take_comment(content[1:].strip(), fields, path)
    raise RecordingError(f"{path} is empty: a recording starts with the header {','.join(REQUIRED_CHANNELS)}")


def _lines(text: str) -> Iterator[str]:
    return iter(io.StringIO(text, newline=""))


def _take_comment(comment: str, fields: dict[str, Any], path: Path) -> None:
    if comment.startswith(_FAMILY):
        if comment != SCHEMA:
            raise RecordingError(f"{path} has schema {comment}, this version reads {SCHEMA}: update fricomp")
        return
    name, separator, value = comment.partition(":")
    if separator and name.strip().isidentifier():
        fields[name.strip()] = _parse_value(value.strip())


def _parse_value(text: str) -> object:
    try:
        return parse_json(text)
    except msgspec.DecodeError:
        return text


def _parse_header(header: str, path: Path) -> list[str]:
    names = [name.strip() for name in header.split(",")]
    hint = "bring other files in with 'fricomp convert SOURCE --mapping FILE'"
    for name in names:
        if name not in CHANNELS:
            raise RecordingError(f"{path}: unknown column {name!r}; valid are {', '.join(CHANNELS)}; {hint}")
        if names.count(name) > 1:
            raise RecordingError(f"{path}: column {name!r} appears twice; keep one")
    missing = [name for name in REQUIRED_CHANNELS if name not in names]
    if missing:
        raise RecordingError(f"{path}: column {missing[0]!r} is missing; {hint}")
    return names


def _drop_torn_line(body: str, width: int, *, signed: bool) -> tuple[str, tuple[Finding, ...]]:
    """Cut off an unfinished last line: one that is too short or, in our own files, not ended."""
    if not body or body.endswith("\n"):
        return body, ()
    end = body.rfind("\n") + 1
    last = body[end:]
    if last.startswith("#") or (not signed and last.count(",") == width - 1):
        return body, ()
    message = f"the last line {last[:40]!r} is unfinished and was left out"
    row = sum(1 for line in body[:end].splitlines() if line.strip() and not line.startswith("#")) + 1
    advice = "nothing to do: the writer was stopped there"
    return body[:end], (Finding("torn_line", "warning", message, advice, row),)


def _parse_table(body: str, names: list[str], *, skip_bad_rows: bool) -> NDArray[np.float64]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # numpy says so when there is no row at all
        try:
            table = np.loadtxt(io.StringIO(body), delimiter=",", comments="#", ndmin=2)
        except ValueError:
            if not skip_bad_rows:
                raise _explain_bad_cell(body, names) from None
            table = _parse_leniently(body, names)
    if table.size == 0:
        raise RecordingError("the file has a header and no rows: record again")
    if table.shape[1] != len(names):
        raise _explain_bad_cell(body, names)
    return np.asarray(table, dtype=np.float64)


def _parse_leniently(body: str, names: list[str]) -> NDArray[np.float64]:
    """The rows with NaN for every cell that is no number, and in all of a row that is cut short or too long."""
    nothing = [float("nan")] * len(names)
    rows = [line.split(",") for line in _data_lines(body)]
    return np.array([[_number(cell) for cell in row] if len(row) == len(names) else nothing for row in rows])


def _data_lines(body: str) -> Iterator[str]:
    return (line for line in body.splitlines() if line.strip() and not line.startswith("#"))


def _number(cell: str) -> float:
    return float(cell) if _is_number(cell) else float("nan")


def _explain_bad_cell(body: str, names: list[str]) -> RecordingError:
    for row, line in enumerate(_data_lines(body), start=1):
        cells = line.split(",")
        if len(cells) != len(names):
            return RecordingError(f"row {row} has {len(cells)} cells where the header has {len(names)}: repair it")
        for name, cell in zip(names, cells, strict=True):
            if not _is_number(cell):
                what = "is empty" if not cell.strip() else f"holds {cell.strip()[:40]!r}, which is no number"
                return RecordingError(f"row {row}, column {name} {what}: repair it or leave the column out")
    return RecordingError("the rows cannot be read as numbers separated by commas")


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # as in 1_0, which is a number in Python and in no log
