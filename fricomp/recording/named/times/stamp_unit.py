"""The unit of a time: by its name, by the day that its stamps are, or by the steps from row to row."""

import re
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import make_narrow
from fricomp.recording.validity import Samples

TIME_UNIT = (
    r"(s|100[ _]?ns|secs?|seconds?|sek|ms|msecs?|milliseconds|us|µs|usecs?|ns|nsecs?|min|h|hrs?|hours?"
    r"|с|сек|мс|мкс|秒|毫秒|微秒)"
)
"""Units of a time as names state them, for a regular expression."""
_SAID = re.compile(rf"(?<![a-zа-я]){TIME_UNIT}[\])]?$", re.IGNORECASE)
_SPELLED = {
    "sec": "s",
    "sek": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "msecs": "ms",
    "milliseconds": "ms",
    "µs": "us",
    **dict.fromkeys(("100 ns", "100_ns"), "100ns"),
    **dict.fromkeys(("hr", "hrs", "hour", "hours"), "h"),
}
_SPELLED |= {
    "usec": "us",
    "usecs": "us",
    "nsec": "ns",
    "nsecs": "ns",
    "с": "s",
    "сек": "s",
    "мс": "ms",
    "мкс": "us",
    "秒": "s",
    "毫秒": "ms",
    "微秒": "us",
}
_ALONE = {"ms": "ms", "us": "us", "ns": "ns", "tms": "ms", "millis": "ms", "tus": "us", "micros": "us", "tns": "ns"}
_ALONE |= {"nanos": "ns"}
"""Names that are a unit of time alone."""
TIME_UNITS = ((0.5, "s"), (500.0, "ms"), (5e5, "us"), (float("inf"), "ns"))
"""Largest median step of stamps, and the unit that they are then in: no arm is logged below 2 Hz or above 2 kHz."""

_EPOCHS = (
    *((least, 4.0 * least, unit) for least, unit in ((1e9, "s"), (1e12, "ms"), (1e15, "us"), (1e18, "ns"))),
    (1.26e17, 1.58e17, "100ns"),
    (6.31e17, 6.63e17, "100ns"),
)
"""Least and largest stamp since 1970, from September 2001 on, and its unit; then the same of Windows' file times, since
1601, and of the ticks of .NET, since the year 1, for the years 2000 to 2100."""
_SINCE_1601, _SINCE_YEAR_1 = 11_644_473_600.0, 62_135_596_800.0
"""Seconds from where file times of Windows and ticks of .NET begin to 1970."""
_MATLAB_1970, _SHEETS_1970 = 719_529.0, 25_569.0
"""The first day of 1970 as MATLAB and as spreadsheets number it."""
_STEP_OF_DAY, _BEGIN_OF_DAY = 2.4e-6, 0.01
"""Step of a part of a day, below which it is that of 5 Hz and more, and where a time of day begins at the earliest."""
_SHORTEST = 1e-6
"""Step of stamps without a unit [s], below which they are in no seconds."""
_WHOLE_RATE = 1e-3
"""Relative distance from a whole number of rows a second up to which ticks are parts of a second."""
_HELD = 0.2
"""Part of the rows with the stamp of the one before, from which on a clock is coarse: rows are more than its steps."""


def read_time_unit(name: str) -> str:
    """The unit that the name of a time states; empty where it is its last word alone, such as `s`."""
    said = _SAID.search(make_narrow(name).rstrip("'"))
    if said is None or said.start() == 0:
        return _ALONE.get(name.lower(), "")
    return _SPELLED.get(said.group(1).lower(), said.group(1).lower())


def guess_unit(stamps: Samples) -> str:
    """The unit of stamps whose name states none: by the day that they are, or by their steps. Shape (n,)."""
    step = measure_step(stamps)
    if unit := find_epoch_unit(stamps, step):
        return unit
    return "d" if _are_days(stamps, step) else next(one for most, one in TIME_UNITS if step <= most)


def measure_step(stamps: Samples) -> float:
    """Usual step of stamps that differ, or the mean of all where a coarse clock holds many."""
    steps = np.abs(np.diff(stamps))
    usual = float(np.median(steps[steps > 0.0], overwrite_input=True)) if steps.any() else 0.0
    return float(np.mean(steps)) if np.mean(steps == 0.0) > _HELD else usual


def find_epoch_unit(stamps: Samples, step: float) -> str:
    """The unit in which stamps with this usual step count since an epoch; empty where they do not."""
    for least, most, one in _EPOCHS:
        if least <= stamps[0] and stamps[-1] <= most and step * find_unit(one).factor <= TIME_UNITS[0][0]:
            return one
    return ""


def find_date(stamp: float, unit: str) -> float:
    """Seconds since 1970 at a stamp in this unit, whatever it counts from; one that is no date stays what it is [s].

    Args:
        stamp: The first one of a log.
        unit: Name of its unit.
    """
    seconds = stamp * find_unit(unit).factor
    if unit == "100ns":
        return seconds - _SINCE_YEAR_1 if stamp > _EPOCHS[-1][0] else seconds - _SINCE_1601
    if unit == "d":
        return seconds - 86400.0 * (_MATLAB_1970 if stamp > _MATLAB_1970 / 2.0 else _SHEETS_1970)
    return seconds


def are_known_ticks(ticks: Samples) -> bool:
    """Whether a counter goes on as ms or us do: at a whole number of rows a second, or unevenly. Shape (n,)."""
    steps = np.diff(ticks)
    step = float(np.mean(steps))
    rate = 1.0 / (step * find_unit(guess_unit(ticks)).factor)
    is_even = bool(np.all(np.abs(steps - step) <= 1.0))
    return not is_even or abs(rate / max(round(rate), 1) - 1.0) <= _WHOLE_RATE


def require_known_ticks(path: Path, name: str, ticks: Samples) -> None:
    """Refuse a counter that goes on by what no parts of a second do: how many of it come a second is not said.

    Args:
        path: Of the log, for messages.
        name: Of the counter.
        ticks: Its numbers. Shape (n,).

    Raises:
        RecordingError: It is such a counter.
    """
    if not are_known_ticks(ticks):
        step = float(np.mean(np.diff(ticks)))
        raise RecordingError(
            f"{path}: {name!r} goes on by {step:.6g} a row, and nothing says how many of them come a second: write "
            f"time = {{ column = {name!r}, scale = 1/TICKS_A_SECOND, from_zero = true }} in a mapping with the number "
            "worked out ('fricomp convert LOG --inspect --out log.toml' begins one), or '# tick rate: 32768 Hz' "
            "above the names"
        )


def _are_days(stamps: Samples, step: float) -> bool:
    """Whether these are days since 1900 or the year 0, as spreadsheets and MATLAB write dates: in seconds such steps
    would be those of 50 kHz and more. A time of day is a part of one: in seconds its steps are those of 400 kHz.
    """
    first, last = float(stamps[0]), float(stamps[-1])
    return (step < 2e-5 and 1e4 < first < 1e6) or (0.0 < step < _STEP_OF_DAY and _BEGIN_OF_DAY < first <= last < 2.0)


def require_slow(path: Path, name: str, stamps: Samples) -> None:
    """Refuse steps that no log has in seconds, where nothing says which unit they are in.

    Args:
        path: Of the log, for messages.
        name: Of the time.
        stamps: Its numbers, taken as seconds. Shape (n,).

    Raises:
        RecordingError: They are such steps.
    """
    step = measure_step(stamps)
    if 0.0 < step < _SHORTEST:
        raise RecordingError(
            f"{path}: {name!r} states no unit, and goes on by {step:.4g} a row, in seconds {1e-6 / step:.3g} million "
            f'rows a second: write time = {{ column = {name!r}, unit = "h", from_zero = true }} in a mapping, or '
            '"min", or "d" of days, whichever it is (\'fricomp convert LOG --inspect --out log.toml\' begins one)'
        )
