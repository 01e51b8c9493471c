"""A log by the mapping that the inspection proposes for it."""

from __future__ import annotations

from pathlib import Path

from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping


def convert_by_proposal(path: Path, folder: Path) -> Recording:
    """The one recording of a log whose names are read, by its mapping as it is written into `folder`."""
    mapping, seen = folder / "log.toml", inspect_log(path)
    assert seen.log is not None
    mapping.write_text(render_mapping(path, seen.log), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    return found.recording
