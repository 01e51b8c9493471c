"""The folder of a diagnosis before another one is written into it: what an earlier one left there is no longer true."""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from pathlib import Path

__all__ = ["RECORD", "check_folder", "remove_earlier_diagnosis"]

RECORD = "diagnosis.json"
_MODEL = "friction.json"
_MODEL_FILES = (_MODEL, "friction.onnx", "friction.xml")
_REPORT, _SUBTITLE = "report.html", '<p class="subtitle">Diagnosis of '
_OTHERS = re.compile(
    r"(report\.html|motion\.csv|(over-time-\d+|where|planes|orders|rivals|distinguishability|motion)\.png)"
)


def check_folder(folder: Path, inputs: Collection[Path]) -> None:
    """Refuse a folder in which a diagnosis would write over what is none of its own.

    Args:
        folder: Where the next diagnosis is written.
        inputs: Files that are given to it.

    Raises:
        DiagnosisError: A file that it writes is one of the inputs, or was not written by a diagnosis.
        ParameterError: The folder is a file, or lies below one.
    """
    from fricomp.cli.out_folder import require_folder
    from fricomp.errors import DiagnosisError

    require_folder(folder)
    for path in inputs:
        if path.resolve().parent == folder.resolve() and _is_output(path.resolve().name):
            raise DiagnosisError(f"a diagnosis into {folder} would write over its input {path}: choose another --out")
    foreign = [name for name in _foreign(folder) if (folder / name).exists()]
    if foreign:
        files = ", ".join(foreign)
        raise DiagnosisError(
            f"{folder} holds {files}, which a diagnosis writes too and which comes from something else, such as a "
            "calibration: choose another --out, or move it away"
        )


def _is_output(name: str) -> bool:
    return name in (RECORD, *_MODEL_FILES) or _OTHERS.fullmatch(name) is not None


def _foreign(folder: Path) -> list[str]:
    """Names of outputs that, if they are there, are no diagnosis'."""
    if not _is_record(folder / RECORD):
        return [RECORD, *_MODEL_FILES, _REPORT, "motion.csv"]
    model, report = _is_of_diagnosis(folder / _MODEL), _is_report(folder / _REPORT)
    return [*(() if model else _MODEL_FILES), *(() if report else (_REPORT,))]


def remove_earlier_diagnosis(folder: Path, keep: Collection[Path] = ()) -> None:
    """Remove what an earlier diagnosis wrote into `folder`; without a record of one there, nothing.

    A model that does not come from a diagnosis stays: a calibration may share the folder.

    Args:
        folder: Where the next diagnosis is written.
        keep: Files that stay, such as those that are diagnosed.

    Raises:
        OSError: A file cannot be removed.
    """
    if not _is_record(folder / RECORD):
        return
    stay = {path.resolve() for path in keep}
    names = [RECORD, *(_MODEL_FILES if _is_of_diagnosis(folder / _MODEL) else ())]
    names += [path.name for path in folder.iterdir() if _OTHERS.fullmatch(path.name)]
    for name in names:
        if (folder / name).resolve() not in stay:
            (folder / name).unlink(missing_ok=True)


def _is_record(path: Path) -> bool:
    """Whether a diagnosis wrote this file, in this version of its schema or another one."""
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return False
    return isinstance(content, dict) and str(content.get("schema")).startswith("fricomp.diagnosis/")


def _is_of_diagnosis(path: Path) -> bool:
    """Whether a model file was written by a diagnosis."""
    from fricomp.errors import FricompError
    from fricomp.model import load_model

    try:
        return load_model(path).provenance.method == "diagnosis"
    except FricompError:
        return False


def _is_report(path: Path) -> bool:
    """Whether a page was written by a diagnosis, as its subtitle says."""
    try:
        return _SUBTITLE in path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
