"""What was believed of a log, as a mapping file to edit."""

from __future__ import annotations

import json
from pathlib import Path

from fricomp.recording.named.log import NamedLog
from fricomp.recording.named.source import find_delimiter, read_first_lines

__all__ = ["render_mapping"]

_TEXT = (".csv", ".txt", ".dat", ".tsv")


def render_mapping(path: Path, log: NamedLog) -> str:
    """A mapping with which `fricomp convert` makes the same recordings of the same file.

    Args:
        path: The log.
        log: What was read from it by names.
    """
    lines = [f"# {path.name}, as the names of its columns say; edit what is wrong", "", *_describe_source(path)]
    joints = {name: dict(columns) for name, columns in log.sources.items()}
    metadata = log.recordings[0].metadata
    facts = {"torque_unit": metadata.torque_unit, "motion": metadata.motion}
    if len(joints) == 1:
        facts = {"joint": metadata.joint, **facts}
    lines += ["", "[metadata]", *(f"{name} = {_quote(value)}" for name, value in facts.items())]
    lines += ["# encoder_resolution = 2.4e-5   # [rad]; where you know it, the checks see by it what is in degrees"]
    clock = next(iter(joints.values()))["time"]
    lines += ["", "[channels]", _rule("time", clock[0], clock[1].unit, "from_zero = true")]
    for name, columns in joints.items():
        table = "" if len(joints) == 1 else "channels."
        lines += [] if len(joints) == 1 else ["", "[[joints]]", f"name = {_quote(name)}"]
        own = ((channel, *source) for channel, source in columns.items() if channel != "time")
        lines += [table + _rule(channel, column, meaning.unit) for channel, column, meaning in own]
    return "\n".join(lines) + "\n"


def _describe_source(path: Path) -> list[str]:
    if path.suffix.lower() not in _TEXT or not path.is_file():
        return []
    head = read_first_lines(path, 1).rows[0]
    mark = find_delimiter(head)
    lines = ["[source]", "header = true", f"delimiter = {_quote(mark)}"]
    return lines if mark == "," else [*lines, 'decimal = ","  # "." where numbers have points']


def _rule(channel: str, column: str, unit: str, *more: str) -> str:
    parts = [f"column = {_quote(column)}", *([f"unit = {_quote(unit)}"] if unit else []), *more]
    return f"{channel} = {{ {', '.join(parts)} }}"


def _quote(text: str) -> str:
    """A text of TOML, whose basic strings are written as those of JSON."""
    return json.dumps(text, ensure_ascii=False)
