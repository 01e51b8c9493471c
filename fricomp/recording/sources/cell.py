"""What a cell of a text says: a number, with or without its unit, a date, or a length of time."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime

from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import read_unit

DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
DECIMAL_POINT = re.compile(r"[+-]?(?:0?\.\d+|\d+\.(?!\d{3}$)\d+|\d{1,3}(?:,\d{3})+\.\d+)(?:[eE][+-]?\d+)?")
"""A number whose point cannot stand between thousands."""
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?")
_DAY_FIRST = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4})[ T]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)")
_SLASHES = re.compile(r"(\d{1,2})/(\d{1,2})/(\d{4})[ T]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)\s*([AaPp][Mm])?")
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_NAMED_MONTH = re.compile(
    rf"(?:[A-Za-z]{{3}},? )?(\d{{1,2}})[- ]({'|'.join(_MONTHS)})[a-z]*\.?[- ](\d{{4}})"
    r"[ T]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)",
    re.IGNORECASE,
)
"""`14-Mar-2026 09:30:00.123`, as MATLAB writes dates."""
DOTTED = re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d+")
"""A number with points between thousands and a decimal comma."""
_GAPPED = re.compile(r"[+-]?\d{1,3}(?:([ \u00a0\u2009\u202f'’])\d{3})(?:\1\d{3})*(?:[.,]\d*)?")
"""A number with spaces or apostrophes between thousands."""
_COMPACT = re.compile(r"(\d{8})[T_-](\d{6})(?:[._,-]?(\d{1,9}))?")
"""A date and time without marks within, as names of files have them: `20240314_235950_004`."""
_FORTRAN = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)")
_CLOCK = re.compile(r"(?:(\d{1,4}):)?(\d{1,2}):(\d{2})(?:[.,:;](\d+))?(?:\s?([AaPp])\.?[Mm]\.?)?")
"""A time of day, or a length of time in hours or in minutes."""
_IEC = re.compile(r"L?T(?:IME)?#(?:[\d.]+(?:d|h|ms|us|ns|m|s)_?)+", re.IGNORECASE)
_IEC_PART = re.compile(r"([\d.]+)(d|h|ms|us|ns|m|s)", re.IGNORECASE)
_IEC_UNITS = {"d": 86400.0, "h": 3600.0, "m": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""A length of time as controllers write it, `T#1s234ms` [iec61131], and its parts [s]."""
_MEASURED = re.compile(r"([+-]?[\d.,]*\d(?:[eE][+-]?\d+)?)\s*([^\W\d_].*|[°µ].*)")
_TIME_WORDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "µs": 1e-6, "us": 1e-6, "ns": 1e-9, "min": 60.0, "hr": 3600.0}
"""Units of time behind a number, as MATLAB writes lengths of time [s]."""
_LIST = re.compile(r"[\[(][\s\d.,;eE+\-naNA]*[\])]?")
_SPAN = re.compile(r"(-?\d+) days?,? \+?(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)")


def is_number(cell: str) -> bool:
    """Whether a cell is a number, a date or a list of numbers, with or without a unit behind it."""
    return is_entry(cell) or read_measured(cell) is not None


def read_measured(cell: str) -> tuple[str, float, float] | None:
    """The number in front of a unit in one cell, and what makes SI of it by factor and offset; None where it is none.

    `12.3°`, `0.002 sec`, `-4,1 N·m`.
    """
    match = _MEASURED.fullmatch(cell.strip().replace("\u2212", "-"))
    if match is None:
        return None
    number, word = match.groups()
    unit = UNITS.get(read_unit(word))
    if unit is not None:
        return number, unit.factor, unit.offset
    return (number, _TIME_WORDS[word.lower()], 0.0) if word.lower() in _TIME_WORDS else None


def read_measured_si(cell: str) -> str:
    """The unit of SI of the number in one cell, `rad` of `12.3°`; empty where it is a time or has no unit."""
    match = _MEASURED.fullmatch(cell.strip().replace("\u2212", "-"))
    unit = UNITS.get(read_unit(match.group(2))) if match else None
    return "" if unit is None else unit.si


def is_entry(cell: str) -> bool:
    """Whether a cell is a number, a date or a list of numbers."""
    if cell[:1] in ("[", "("):
        return any(map(str.isdigit, cell)) and _LIST.fullmatch(cell) is not None
    try:
        parse_number(cell, ",")
    except ValueError:
        return False
    return True


def parse_number(cell: str, decimal: str) -> float:
    """A number, also with a decimal comma or with commas between thousands, or in hexadecimal digits behind `0x`.

    Spaces and apostrophes between thousands, the minus sign of Unicode and Fortran's `1.2D-3` are read too. Of a date
    and time by ISO 8601, with the day first and dots between, or with slashes (the month first, where that can be), it
    is the seconds since 1970; of a time of day those since midnight [s]; of `0 days 00:00:01.5`, of `02:03.5` and of
    `T#2m3s500ms` its length.

    Raises:
        ValueError: It is none.
    """
    text = cell.strip().strip('"').replace("\u2212", "-")
    gapped = _GAPPED.fullmatch(text)
    if gapped:
        text = text.replace(gapped.group(1), "")
    if "," in text:
        text = _without_commas(text, decimal)
    try:
        if "_" in text:  # which Python takes between digits
            raise ValueError(text)
        return float(int(text, 16)) if text[:2] in ("0x", "0X") else float(text)
    except ValueError:
        fortran = _FORTRAN.fullmatch(text)
        return float("e".join(fortran.groups())) if fortran else _parse_stamp(text)


def number_or_nan(cells: Sequence[str], index: int, decimal: str) -> float:
    """The number in one of several cells; NaN where it is none or missing."""
    try:
        return parse_number(cells[index], decimal)
    except (ValueError, IndexError):
        return float("nan")


def read_number(cell: str) -> float:
    """The number in a cell, with a decimal point; NaN where it is none."""
    return number_or_nan((cell,), 0, ".")


def _without_commas(text: str, decimal: str) -> str:
    if decimal == "," and DECIMAL_COMMA.fullmatch(text):
        return text.replace(",", ".")
    if decimal == "," and DOTTED.fullmatch(text):
        return text.replace(".", "").replace(",", ".")
    return text.replace(",", "") if THOUSANDS.fullmatch(text) else text


def _reorder(first: str, second: str, year: str, clock: str, half: str | None) -> str:
    """A date between slashes as ISO 8601 has it; the first number is the month where it can be one."""
    day, month = (int(first), int(second)) if int(first) > 12 else (int(second), int(first))
    hours, rest = clock.split(":", 1)
    hour = int(hours) % 12 + 12 * (half.lower() == "pm") if half else int(hours)
    return f"{year}-{month:02d}-{day:02d} {hour:02d}:{rest}"


_ZONE = re.compile(r"(?<=:\d\d)(\.\d+)?\s[A-Z]{3,4}$")
"""The name of a zone behind a time of day: `10:00:00.25 UTC`. All rows have the same, so that it moves none."""


def _parse_stamp(text: str) -> float:
    text = _ZONE.sub(r"\1", text)
    span = _SPAN.fullmatch(text)
    if span:
        days, hours, minutes, seconds = span.groups()
        return 86400.0 * int(days) + 3600.0 * int(hours) + 60.0 * int(minutes) + float(seconds)
    slashes = _SLASHES.fullmatch(text)
    if slashes:
        text = _reorder(*slashes.groups())
    named = _NAMED_MONTH.fullmatch(text)
    if named:
        day, month, year, clock = named.groups()
        text = f"{day}.{_MONTHS.index(month.lower()) + 1}.{year} {clock}"
    european = _DAY_FIRST.fullmatch(text)
    if european:
        day, month, year, clock = european.groups()
        text = f"{year}-{int(month):02d}-{int(day):02d} {clock.zfill(8)}"
    clock_time = _CLOCK.fullmatch(text)
    if clock_time and (clock_time.group(1) or clock_time.group(4)):
        hours, minutes, seconds, rest = clock_time.groups("0")[:4]
        if clock_time.group(5):
            hours = str(int(hours) % 12 + 12 * (clock_time.group(5) in "Pp"))
        return 3600.0 * int(hours) + 60.0 * int(minutes) + float(f"{seconds}.{rest}")
    if _IEC.fullmatch(text):
        return sum(float(number) * _IEC_UNITS[unit.lower()] for number, unit in _IEC_PART.findall(text))
    compact = _COMPACT.fullmatch(text)
    if compact:
        text = f"{compact.group(1)}T{compact.group(2)}.{(compact.group(3) or '0').ljust(6, '0')[:6]}"
    stamp = datetime.fromisoformat(text)
    return (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()
