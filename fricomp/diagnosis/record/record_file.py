"""The record of a diagnosis as a file, `diagnosis.json`."""

from __future__ import annotations

from inspect import cleandoc
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.untrusted import parse_json, read_whole
from fricomp.whole_file import write_whole

from .result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord


def diagnosis_json_schema() -> dict[str, Any]:
    """The JSON schema of `diagnosis.json`; `docs/diagnosis.schema.json` holds it too."""
    schema = msgspec.json.schema(DiagnosisRecord)
    for part in schema["$defs"].values():
        part["description"] = cleandoc(part["description"])  # Python 3.13 does it by itself
    return schema


def save_diagnosis(diagnosis: Diagnosis | DiagnosisRecord, path: str | Path) -> None:
    """Write `diagnosis.json`, whole or not at all.

    Raises:
        DiagnosisError: The file cannot be written.
    """
    record = diagnosis.record if isinstance(diagnosis, Diagnosis) else diagnosis
    data = msgspec.json.encode(record, enc_hook=_convert_number)
    write_whole(Path(path), msgspec.json.format(data, indent=2) + b"\n", DiagnosisError)


def _convert_number(value: Any) -> float:
    """A number of numpy as one of Python."""
    if isinstance(value, np.generic):
        return float(value)
    raise DiagnosisError(f"a diagnosis holds {value!r} of {type(value).__name__}, which is not a number")


def load_diagnosis(path: str | Path) -> DiagnosisRecord:
    """Read `diagnosis.json`.

    Raises:
        DiagnosisError: The file is missing, damaged, or of another schema.
    """
    try:
        record = parse_json(read_whole(path), DiagnosisRecord)
    except OSError as error:
        raise DiagnosisError(f"cannot read the diagnosis {path}: {error.strerror or error}") from error
    except msgspec.DecodeError as error:
        raise DiagnosisError(f"{path} is not a diagnosis, or is damaged: {error}") from error
    if record.schema != DIAGNOSIS_SCHEMA:
        raise DiagnosisError(f"{path} has schema {record.schema!r}; this version reads {DIAGNOSIS_SCHEMA!r}")
    return record
