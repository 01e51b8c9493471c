"""Facts that stand above the rows of a text: the rate of its rows, ratings, constants and gears.

A rate stands in for a time that no column holds. What is worth of a unit hangs on which side of a gear a column is:
that is said beside what is asked for, and not done.
"""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from itertools import islice, pairwise
from pathlib import Path
from typing import NamedTuple

from fricomp.recording.sources import is_text
from fricomp.recording.sources.text import find_encoding
from fricomp.recording.sources.text_layout import FIRST_LINES, find_layout
from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import read_unit
from fricomp.recording.validity import Samples

from .column import read_column_name

_PER_TURN = r"(?:/|per|a|pro)[ _]*(?:rev\w*|turn|umdrehung)"
_OBJECT = r"(?:\s*[\[(]?0x[0-9a-f]{4}(?:[:.]\d+)?[\])]?)?"
"""The object of a drive that a fact is, behind its name: `rated torque (0x6076)`."""
_CALLED = {
    "rate": r"(?:sampl\w*|log\w*|record\w*|acquisition|update|abtast\w*)[ _-]*(?:rate|freq\w*)|abtastrate|fs|f_s",
    "tick_rate": r"(?:ticks?|timer|counter)[ _-]*(?:rate|freq\w*|clock)|ticks?[ _-]*(?:per|/)[ _-]*s(?:ec(?:ond)?)?",
    "delta_x": r"delta_x|[tx]_?inc(?:r|rement)?",
    "step": r"(?:sampl\w*|cycle|abtast\w*|zyklus)[ _-]*(?:interval|time|period|zeit)",
    "COUNTS_A_TURN": rf"(?:encoder[ _-]*)?cpr|counts?[ _]*{_PER_TURN}|(?:increments?|inkremente|inc)[ _]*{_PER_TURN}",
    "RATED": r"(?:rated|nominal)[ _-]*(?:motor[ _-]*)?torque|nenn(?:dreh)?moment",
    "RATED_CURRENT": r"(?:rated|nominal)[ _-]*(?:motor[ _-]*)?current|nennstrom",
    "KT": r"k_?t|torque[ _-]*constant|drehmomentkonstante",
    "RATIO": r"(?:gear[ _-]*ratio|reduction(?:[ _-]*ratio)?|(?:getriebe)?übersetzung)",
}
"""What each fact is called, by what stands for it in a mapping that is proposed."""
_NUMBER = r"[+-]?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?"
_FACT = {
    name: re.compile(
        rf"(?<![\w.])(?:{called}){_OBJECT}\s*(?:[\[(]([^\])]*)[\])])?\s*[:=;,\t ]\s*"
        rf"({_NUMBER})(?:\s*[:/]\s*({_NUMBER}))?"
        r"(?:\s*[;,]?\s*[\[(]?([^\W\d][^\s;,\])]*))?",
        re.IGNORECASE,
    )
    for name, called in _CALLED.items()
}
_BITS = re.compile(r"encoder\D{0,20}?(\d\d)[ -]?bits?\b|(?<!\d)(\d\d)[ -]?bit[ -](?:\w+[ -])?encoder", re.IGNORECASE)
"""Bits of a turn: `encoder: 14 bit`, `17-bit absolute encoder`."""
_BEFORE = re.compile(rf"(\d+)[ _]*(?:cpr(?![a-z])|(?:counts?|cts|inc(?:r|rements?)?|inkremente)[ _]*{_PER_TURN})", re.I)
"""Counts of a turn before what they are: `encoder (4096 cpr)`, `Resolution: 8192 inc/rev`."""
_RATES = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6, "s/s": 1.0, "sps": 1.0, "samples/s": 1.0, "1/s": 1.0}
_STEPS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
"""What one of a unit is [Hz] or [s]."""


_PRESENT = re.compile(r"(?:^|[./ _\]])present[_ ]?(position|velocity|current)(?:[_ .\[(]?\d+[\])]?)?$", re.IGNORECASE)
"""Registers of a Dynamixel X, as its programs call the columns [robotis2024]."""


class Register(NamedTuple):
    """What one of a register is.

    Attributes:
        worth: In SI.
        said: The same in words.
    """

    worth: float
    said: str


_WORTH = {
    "position": Register(0.00153398, "4096 a turn of a Dynamixel X"),
    "velocity": Register(0.0239808, "0.229 rpm of a Dynamixel X"),
    "current": Register(0.00269, "2.69 mA of most Dynamixel X, 1 mA of XL330 and XC330: see its manual"),
}


class HeadFact(NamedTuple):
    """A number that is stated above the rows.

    Attributes:
        value: In SI, of a rate in Hz.
        said: As it stands there.
    """

    value: float
    said: str


def read_head_facts(path: Path) -> dict[str, HeadFact]:
    """What is stated above the rows of a text, by what stands for it in a mapping; `rate` is that of the rows [Hz].

    Nothing of any other file, nor what is stated twice with other numbers.
    """
    return _find_facts(read_head(path))


def read_head_lines(path: Path) -> list[str]:
    """The lines above the rows of a text that are no names of its columns and no units below them."""
    return [line.strip(' "#%/\r\n') for line in read_head(path, with_names=False)]


def read_head(path: Path, *, with_names: bool = True) -> list[str]:
    """The lines above the rows of a text, with those of the names or without them; none of any other file."""
    if not path.is_file() or not is_text(path):
        return []
    with path.open(encoding=find_encoding(path), errors="replace") as stream:
        lines = list(islice(stream, FIRST_LINES))
    try:
        layout = find_layout(lines)
    except csv.Error:
        return []
    if layout is None:
        return []
    return lines[: layout.rows_line] if with_names else lines[: layout.names_line]


def _find_facts(lines: Sequence[str]) -> dict[str, HeadFact]:
    found: dict[str, set[HeadFact]] = {}
    for above, below in pairwise(lines):
        for word, number in zip(above.split(","), below.split(","), strict=False):
            if word.strip().lower() == "increment" and re.fullmatch(_NUMBER, number.strip()):
                found["delta_x"] = {HeadFact(float(number), f"{word.strip()} {number.strip()}")}  # as Rigol's scopes
    for line in lines:
        for name, pattern in _FACT.items():
            for match in pattern.finditer(line):
                value = _read_value(name, *match.groups(""))
                if value is not None and value > 0.0:
                    found.setdefault(name, set()).add(HeadFact(value, match.group().strip(' "\r\n')))
        for name, fact in _find_counts(line).items():
            found.setdefault(name, set()).add(fact)
    facts = {name: next(iter(said)) for name, said in found.items() if len({one.value for one in said}) == 1}
    step = facts.pop("delta_x", None) or facts.pop("step", None)
    return {"rate": HeadFact(1.0 / step.value, step.said), **facts} if step is not None else facts


def _read_value(name: str, unit: str, number: str, over: str, behind: str) -> float | None:
    """The value of a fact in SI; None where its unit is not known, or it is no number of such a kind."""
    value = float(number.replace(",", "."))
    unit = (unit or behind).strip()
    if name in ("rate", "step", "tick_rate", "delta_x"):
        factor = {"step": _STEPS, "delta_x": {"": 1.0}}.get(name, _RATES).get(unit.lower())
        return None if factor is None else value * factor
    if name == "RATIO":
        second = float(over.replace(",", ".")) if over else 1.0
        return max(value / second, second / value) if second and value else None
    if name in ("RATED", "RATED_CURRENT", "KT"):
        return _read_rating(value, unit)
    return value if value == round(value) else None


def _read_rating(value: float, unit: str) -> float | None:
    """A rating or a constant in SI, `mNm/A` too; None where its unit is not known."""
    if not unit:
        return value
    factors = [UNITS.get(read_unit(one)) for one in unit.split("/", maxsplit=1)]
    if factors[0] is None:
        return None
    below = factors[1].factor if len(factors) > 1 and factors[1] is not None else 1.0
    return value * factors[0].factor / below


def say_head_facts(path: Path, text: str, column: str = "", beside: Mapping[str, Samples] | None = None) -> str:
    """A message with what of the things that it asks for stands in the file; as it is where none does.

    Args:
        path: Of the file.
        text: Of the message, with `RATED`, `COUNTS_A_TURN` and the like.
        column: Name of the column, which may state its counts a turn itself.
        beside: All columns by name, of which those of one number may be facts.
    """
    facts = read_head_facts(path) | find_counts_beside(beside or {}) | _find_counts(column)
    if "gear" in text and "RATIO" in facts and "RATIO" not in text:
        text = text.replace("gear ratio", "gear ratio RATIO", 1)
    facts = _choose_rated(facts, of_current="rated current" in text)
    known = [
        f"{name} is {one.value:.6g} by {one.said!r}" for name, one in facts.items() if re.search(rf"\b{name}\b", text)
    ]
    if known:
        return f"{text}; in this file {', '.join(known)}"
    register = find_register(column)
    return f"{text}; {register.worth:g} where it is {register.said}" if register else text


def fill_head_facts(path: Path, line: str, column: str) -> str:
    """A line of a proposed mapping with numbers that stand in the file, and a remark on where they do."""
    meaning = read_column_name(column)
    of_current = meaning is not None and meaning.channel == "current"
    facts = _choose_rated(read_head_facts(path) | _find_counts(column), of_current=of_current)
    rated, counts = facts.get("RATED"), facts.get("COUNTS_A_TURN")
    share = re.search(r"RATED/(\d+)", line)
    if rated is not None and share:
        filled = line.replace(share.group(), f"{rated.value / float(share.group(1)):.8g}")
        gear = "" if of_current else "; times the gear ratio where the position is behind a gear"
        return f"{filled}  # by {rated.said!r}{gear}"
    counted = ("position", "velocity") if "/s" in column else ("position",)
    if counts is not None and "VALUE_OF_ONE" in line and line.lstrip().removeprefix("channels.").startswith(counted):
        filled = line.replace("VALUE_OF_ONE", f"{math.tau / counts.value:.9g}")
        return f"{filled}  # by {counts.said!r}; over the gear ratio where it is a motor's"
    register = find_register(column) if "VALUE_OF_ONE" in line else None
    return f"{line.replace('VALUE_OF_ONE', f'{register.worth:g}')}  # {register.said}" if register else line


def _choose_rated(facts: dict[str, HeadFact], *, of_current: bool) -> dict[str, HeadFact]:
    """The facts with that rating as `RATED` which a column is a part of: the torque's, or the current's."""
    left = {name: fact for name, fact in facts.items() if name not in ("RATED", "RATED_CURRENT")}
    rated = facts.get("RATED_CURRENT" if of_current else "RATED")
    return left if rated is None else {**left, "RATED": rated}


def find_counts_beside(columns: Mapping[str, Samples]) -> dict[str, HeadFact]:
    """Counts of a turn that stand beside the columns as one number: `cpr` in a NumPy archive, or an attribute of HDF5.

    Nothing where several are stated that differ.
    """
    called = re.compile(rf"(?:.*[._/ ])?(?:{_CALLED['COUNTS_A_TURN']})", re.IGNORECASE)
    known = {name: float(values[0]) for name, values in columns.items() if values.size == 1 and called.fullmatch(name)}
    stated = {value for value in known.values() if value > 0.0 and value == round(value)}
    if len(stated) != 1:
        return {}
    (value,) = stated
    return {"COUNTS_A_TURN": HeadFact(value, next(name for name, one in known.items() if one == value))}


def _find_counts(column: str) -> dict[str, HeadFact]:
    match = _BEFORE.search(column)
    if match:
        return {"COUNTS_A_TURN": HeadFact(float(match.group(1)), match.group())}
    bits = _BITS.search(column)
    return {"COUNTS_A_TURN": HeadFact(2.0 ** int(bits.group(1) or bits.group(2)), bits.group())} if bits else {}


def find_register(name: str) -> Register | None:
    """The register that a column is called as, `Present_Position`, `servo.present_current_2`; None of any other.

    Args:
        name: Of the column.
    """
    found = _PRESENT.search(name)
    return _WORTH[found.group(1).lower()] if found else None
