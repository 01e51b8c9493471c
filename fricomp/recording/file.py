"""Recordings on disk: the suffix of the path decides between CSV and Parquet."""

import warnings
from pathlib import Path

from fricomp.errors import RecordingError
from fricomp.recording.csv_file import FileContent, read_csv, write_csv
from fricomp.recording.finding import RecordingWarning
from fricomp.recording.parquet_file import read_parquet, write_parquet
from fricomp.recording.recording import Recording

_CSV = (".csv", ".txt")
_PARQUET = (".parquet", ".pq")


def write_recording(recording: Recording, path: str | Path) -> None:
    """Write a recording as CSV or Parquet; the file appears whole or not at all.

    Raises:
        RecordingError: The suffix is unknown, or the file cannot be written.
        MissingExtraError: Parquet is asked for and pyarrow is not installed.
    """
    target = Path(path)
    if _suffix(target) in _PARQUET:
        write_parquet(recording, target)
    else:
        write_csv(recording, target)


def read_recording(path: str | Path) -> Recording:
    """Read a CSV or Parquet recording.

    Warns with `RecordingWarning` when the file ends in an unfinished line.
    `check_recording` looks for what may mislead: units, signs, gaps, wraps.

    Raises:
        RecordingError: The file is missing, damaged, or its samples cannot be used; the
            message names row, column and what to do.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    content = read_content(Path(path))
    for finding in content.findings:
        warnings.warn(f"{path}: {finding}", RecordingWarning, stacklevel=2)
    return content.recording


def read_content(path: Path, *, skip_bad_rows: bool = False, row_rate: float | None = None) -> FileContent:
    """Read a recording with what was wrong with its file; nothing is warned about.

    Args:
        path: File.
        skip_bad_rows: Leave out rows without a finite number in every column or with a time that does not advance;
            a finding says how many.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.

    Raises:
        RecordingError: As for `read_recording`.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    if not path.exists():
        raise RecordingError(f"no recording at {path}: check the path")
    if path.is_dir():
        raise RecordingError(f"{path} is a folder: name the recording inside it")
    if _suffix(path) in _PARQUET:
        return read_parquet(path, skip_bad_rows=skip_bad_rows, row_rate=row_rate)
    return read_csv(path, skip_bad_rows=skip_bad_rows, row_rate=row_rate)


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in _CSV + _PARQUET:
        raise RecordingError(
            f"{path.name!r} is neither {' nor '.join(_CSV + _PARQUET)}: "
            "other formats come in with 'fricomp convert SOURCE --mapping FILE --out recording.csv'"
        )
    return suffix
