"""Recordings as Parquet: one float64 column a channel, metadata as JSON in the schema."""

from pathlib import Path
from typing import Any

import msgspec

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.csv_file import SCHEMA, FileContent
from fricomp.recording.finding import Finding
from fricomp.recording.metadata import metadata_from_fields, metadata_to_fields
from fricomp.recording.recording import Recording
from fricomp.recording.stamps import with_row_rate
from fricomp.recording.validity import drop_bad_rows, mend_stamps
from fricomp.untrusted import find_size_limit, parse_json
from fricomp.whole_file import whole_file

KEY = b"fricomp.recording"


def write_parquet(recording: Recording, path: Path) -> None:
    """Write a recording; the file appears whole or not at all.

    Raises:
        MissingExtraError: pyarrow is not installed.
        RecordingError: The folder cannot be written, or the disk is full.
    """
    pyarrow, parquet = _import_pyarrow()
    fields = {"schema": SCHEMA, **metadata_to_fields(recording.metadata)}
    table = pyarrow.table(recording.channels).replace_schema_metadata({KEY: msgspec.json.encode(fields)})
    with whole_file(path, RecordingError) as temporary:
        parquet.write_table(table, temporary)


def read_parquet(path: Path, *, skip_bad_rows: bool = False, row_rate: float | None = None) -> FileContent:
    """Read a recording; a Parquet file of another program needs the same column names.

    Args:
        path: File.
        skip_bad_rows: Leave out rows without a finite number in every column or with a time that does not advance.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.

    Raises:
        MissingExtraError: pyarrow is not installed.
        RecordingError: The file cannot be read or is no recording.
    """
    _, parquet = _import_pyarrow()
    try:
        with parquet.ParquetFile(path) as file:
            if file.metadata.num_rows * max(file.metadata.num_columns, 1) * 8 > find_size_limit(path):
                raise RecordingError(f"{path} claims {file.metadata.num_rows} rows: it is damaged, or no recording")
            table = file.read()
        columns = {name: table.column(name).to_numpy() for name in table.column_names}
    except RecordingError:
        raise
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror or error}") from error
    except MemoryError as error:
        raise RecordingError(f"{path} claims more content than there is memory: it is damaged") from error
    except Exception as error:  # pyarrow's own kinds, and what damaged bytes make it stumble over
        raise RecordingError(f"{path} is no Parquet file: {error}") from error
    columns = with_row_rate(columns, row_rate)
    findings: tuple[Finding, ...] = ()
    try:
        fields = _decode_fields((table.schema.metadata or {}).get(KEY))
        if skip_bad_rows and "time" in columns and all(c.dtype.kind in "fiu" for c in columns.values()):
            columns, findings = drop_bad_rows(columns)
        columns, repeated = mend_stamps(columns)
        return FileContent(Recording.from_channels(columns, metadata_from_fields(fields)), findings + repeated)
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from error


def _decode_fields(encoded: bytes | None) -> dict[str, Any]:
    if encoded is None:
        return {}
    try:
        fields = parse_json(encoded, dict[str, Any])
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise RecordingError(f"its metadata are damaged: {error}") from error
    schema = fields.pop("schema", SCHEMA)
    if schema != SCHEMA:
        raise RecordingError(f"its schema is {schema}, this version reads {SCHEMA}: update fricomp")
    return fields


def _import_pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise MissingExtraError("pyarrow", "parquet") from error
    return pyarrow, parquet
