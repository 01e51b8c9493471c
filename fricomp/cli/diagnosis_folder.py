"""The folder of a diagnosis before another one is written into it: what an earlier one left there is no longer true."""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from pathlib import Path

__all__ = ["remove_earlier_diagnosis"]

_RECORD, _MODEL = "diagnosis.json", "friction.json"
_MODEL_FILES = (_MODEL, "friction.onnx", "friction.xml")
_OTHERS = re.compile(
    r"(report\.html|motion\.csv|(over-time-\d+|where|planes|orders|rivals|distinguishability|motion)\.png)"
)


def remove_earlier_diagnosis(folder: Path, keep: Collection[Path] = ()) -> None:
    """Remove what an earlier diagnosis wrote into `folder`; without a record of one there, nothing.

    A model that does not come from a diagnosis stays: a calibration may share the folder.

    Args:
        folder: Where the next diagnosis is written.
        keep: Files that stay, such as those that are diagnosed.

    Raises:
        OSError: A file cannot be removed.
    """
    if not _is_record(folder / _RECORD):
        return
    stay = {path.resolve() for path in keep}
    names = [_RECORD, *(_MODEL_FILES if _is_of_diagnosis(folder / _MODEL) else ())]
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
