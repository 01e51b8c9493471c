"""What was believed of a log, as a mapping file to edit."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from fricomp.recording.finding import Finding
from fricomp.recording.named.choice import INTEGRAL
from fricomp.recording.named.column import ColumnMeaning
from fricomp.recording.named.head_fact import read_head_facts
from fricomp.recording.named.log import NamedLog
from fricomp.recording.named.source import choose_topics, read_layout
from fricomp.recording.named.times.clock import AT_RATE, PARTS_OF_SECONDS, says_steps
from fricomp.recording.sources import is_text
from fricomp.recording.sources.text_layout import TextLayout
from fricomp.recording.unit import find_unit

from .motor_side import name_joint_scale

_ENCODER = "# encoder_resolution = 2.4e-5   # [rad]; where you know it, the checks see by it what is in degrees"

_SCALE = 'in place of it, with torque_unit = "N·m": N·m at the joint of one {unit}, torque constant times gear ratio'


def render_mapping(path: Path, log: NamedLog, findings: Mapping[str, Sequence[Finding]] | None = None) -> str:
    """A mapping with which `fricomp convert` makes the same recordings of the same file.

    Args:
        path: The log.
        log: What was read from it by names.
        findings: What the checks say, by joint: an error stands as a remark behind the column that has it.
    """
    layout = read_layout(path) if path.is_file() and is_text(path) else None
    lines = [f"# {path.name}, as the names of its columns say; edit what is wrong", ""]
    lines += ["skip_bad_rows = true", ""] if any(len(one) < log.rows for one in log.recordings) else []
    lines += describe_source(path, layout)
    layout = None if layout is not None and _has_names_of_its_own(log, layout) else layout
    joints = {name: dict(columns) for name, columns in log.sources.items()}
    metadata = log.recordings[0].metadata
    facts = {"torque_unit": metadata.torque_unit, "motion": metadata.motion, "torque_kind": metadata.torque_kind}
    if len(joints) == 1:
        facts = {"joint": metadata.joint, **facts}
    lines += ["", "[metadata]", *(f"{name} = {_quote(value)}" for name, value in facts.items())]
    known = {name: getattr(metadata, name) for name in ("gear_ratio", "encoder_resolution")}
    lines += [f"{name} = {value!r}" for name, value in known.items() if value is not None]
    lines += ['torque_side = "motor"'] if metadata.torque_side == "motor" else []
    lines += [] if known["encoder_resolution"] else [_ENCODER]
    stamps, meaning = next(iter(joints.values()))["time"]
    lines += ["", "[channels]", _render_time(stamps, meaning.unit, layout)]
    for name, columns in joints.items():
        table = "" if len(joints) == 1 else "channels."
        lines += [] if len(joints) == 1 else ["", "[[joints]]", f"name = {_quote(name)}"]
        own = ((channel, *source) for channel, source in columns.items() if channel != "time")
        wrong = {one.column: one for one in (findings or {}).get(name, ()) if one.severity == "error"}
        lines += [
            table + _rule(channel, column, one.unit, layout, *_scale(one)) + _say_error(wrong.get(channel))
            for channel, column, one in own
        ]
        if metadata.torque_unit == "A" and "torque" in columns:
            column, meaning = columns["torque"]
            lines.append(_render_torque(path, table, render_column(column, layout), meaning))
    return "\n".join(lines) + "\n"


def _has_names_of_its_own(log: NamedLog, layout: TextLayout) -> bool:
    """Whether some column is called as no line of the file has it: all are called so then, and have no numbers."""
    used = {column for columns in log.sources.values() for column, _ in columns.values()}
    index = {"time"} if layout.names and not layout.names[0] else set()
    said = {*layout.names, *index, INTEGRAL}
    is_joined = any(mark in column for column in used for mark in (AT_RATE, *PARTS_OF_SECONDS.values()))
    return bool(layout.names) and not is_joined and not used <= said


def _render_torque(path: Path, table: str, column: str, meaning: ColumnMeaning) -> str:
    """The rule that makes a torque in N·m of a current, as a remark: by constant and gear that the log states."""
    facts = read_head_facts(path)
    constant, worth, by = facts.get("KT"), "0.1", ""
    if constant is not None:
        one = constant.value * meaning.scale * find_unit(meaning.unit or "A").factor
        by, worth = name_joint_scale(one, constant, facts.get("RATIO"))
    rule = f"torque = {{ column = {column}, scale = {worth} }}"
    return f"# {table}{rule}   # {_SCALE.format(unit=_say_step(meaning))}{by and f'; {by}'}"


def _say_error(finding: Finding | None) -> str:
    return "" if finding is None else f"  # {finding.message}: {finding.advice}"


def _render_time(stamps: str, unit: str, layout: TextLayout | None) -> str:
    """The rule for the time: of one column, of a stamp in two, or of rows by their rate."""
    counter, at, rate = stamps.rpartition(AT_RATE)
    if at and rate.endswith(" Hz"):
        hertz = float(rate.removesuffix(" Hz"))
        if not counter:
            return f"time = {{ rate = {hertz!r} }}"
        return _rule("time", counter, "", layout, f"scale = {1.0 / hertz!r}", "from_zero = true")
    seconds, parts = stamps, list[str]()
    for part, one in (("nanoseconds", 1e-9), ("microseconds", 1e-6), ("milliseconds", 1e-3)):
        between = PARTS_OF_SECONDS[one]
        if between in stamps:
            seconds, rest = stamps.split(between)
            parts = [f"{part} = {render_column(rest, layout)}"]
    parts += ["steps = true"] if says_steps(seconds) else []
    return _rule("time", seconds, unit, layout, *parts, "from_zero = true")


def describe_source(path: Path, layout: TextLayout | None) -> list[str]:
    """Lines of a mapping that say how a file is read: where the names of a text are, or the topics of a bag."""
    if layout is None:
        source = choose_topics(path)
        joined = ", ".join(map(_quote, source.join))
        return ["[source]", f"topic = {_quote(source.topic)}", f"join = [{joined}]"] if source.join else []
    skipped = layout.names_line if layout.is_plain else layout.rows_line
    lines = ["[source]", f"header = {str(layout.is_plain).lower()}", f"delimiter = {_quote(layout.delimiter)}"]
    lines += [f"skip_lines = {skipped}"] if skipped else []
    if layout.decimal == ",":
        return [*lines, 'decimal = ","  # "." where numbers have points']
    return lines if layout.delimiter == "," else [*lines, 'decimal = "."']


def _scale(meaning: ColumnMeaning) -> list[str]:
    return [] if meaning.scale == 1.0 else [f"scale = {meaning.scale!r}"]


def _say_step(meaning: ColumnMeaning) -> str:
    """What one of a current's numbers is."""
    unit = meaning.unit or "A"
    return unit if meaning.scale == 1.0 else f"step of {meaning.scale:g} {unit}"


def _rule(channel: str, column: str, unit: str, layout: TextLayout | None, *more: str) -> str:
    if column == INTEGRAL:
        return f'{channel} = {{ integral_of = "velocity" }}'
    parts = [f"column = {render_column(column, layout)}", *([f"unit = {_quote(unit)}"] if unit else []), *more]
    return f"{channel} = {{ {', '.join(parts)} }}"


def render_column(name: str, layout: TextLayout | None) -> str:
    """The name of a column, or its number where the file does not have the name as it was read."""
    if layout is not None and layout.names and not layout.names[0] and name == "time" and name not in layout.names:
        return "1"  # an index, whose column has no name
    if layout is None or layout.is_plain or name not in layout.names:
        return _quote(name)
    return f"{layout.names.index(name) + 1}"


def _quote(text: str) -> str:
    """A text of TOML, whose basic strings are written as those of JSON."""
    return json.dumps(text, ensure_ascii=False)
