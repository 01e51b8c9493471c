"""The column of time of a log, its unit, and the time of its rows."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.named.choice import list_names
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.head_fact import read_head_facts
from fricomp.recording.quantity_word import TIMES
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import make_narrow
from fricomp.recording.validity import Samples, find_readings

from .row_rate import say_row_rate
from .stamp_unit import (
    TIME_UNIT,
    find_date,
    find_epoch_unit,
    guess_unit,
    measure_step,
    read_time_unit,
    require_known_ticks,
    require_slow,
)

_CLOCK = r"(epoch|unix|utc|gmt|host|pc|mono|monotonic|boot|rel|abs|local|system|sys)"
"""Words that say whose clock it is, or since when it counts."""
_TIME = re.compile(
    rf"^(?!th$)(.*[/_. ])?({'|'.join(TIMES)}|time stamps?|__time|date[_/ ]?time|метка времени|x_value)"
    rf"([_ ]{_CLOCK})*((_in_|\s+in\s+|[_\s\[(,/.-]*)({TIME_UNIT[1:-1]}|(hh:)?mm:ss.*)[\])]?)?$"
    rf"|^(secs?|seconds?|t?ms|millis(\(\))?|micros(\(\))?|t?us|t?ns|nanos(\(\))?|ticks?_[mun]s|epoch)$"
    rf"|^{_CLOCK}[_ ]{TIME_UNIT}$"
    r"|^(time|timestamp|zeit)/.*$"
    r"|^[mun]?s[_ ](today|elapsed|(since|from)[_ ].*)$",
    re.IGNORECASE,
)
_STEPS = re.compile(
    r"^(.*[/_. ])?(d_?t|[δΔ∆]_?t|delta[_ ]?(t|time)|time[_ ]?(delta|step|diff)|t_?step)"
    rf"[_\s\[(]*({TIME_UNIT[1:-1]})?[\])]?$",
    re.IGNORECASE,
)
"""Names of a time since the row before."""
_WORD_BEGINS = re.compile(r"(?<=[a-z])(?=[A-Z])")
"""Where the next word begins in a name that marks it by a capital letter alone."""
_PERIOD = re.compile(
    r"^(.*[/_. ])?(d_?t|[δΔ∆]_?t|t_?s|time_?step|(sampl\w*|cycle)[_ ]?(time|period|interval)|period)"
    rf"[_\s\[(]*({TIME_UNIT[1:-1]})?[\])]?$",
    re.IGNORECASE,
)
"""Names of a single number that is the time from row to row."""
_RATE = re.compile(
    r"^(.*[/.])?((sampl\w*|log\w*|record\w*|data|row|control|update)[_ ]?)?(rate|freq|frequency|fps|hz)"
    r"[_ ]?[\[(]?(hz)?[\])]?$|^(.*[/.])?(fs|f_s)$",
    re.IGNORECASE,
)
"""Names of a single number that is how many rows come a second."""
_TIME_UNIT = re.compile(rf"[\[(]\s*{TIME_UNIT}\s*[\])]\s*$", re.IGNORECASE)
_ENDS_IN_UNIT = re.compile(r"[_ ](ms|us|µs|ns|msec|usec|nsec)$", re.IGNORECASE)
_COUNTER = re.compile(
    r"(^|[/_. ])(samples?|index|idx|n|nr|no|counter|count|cycles?|rows?)([_ ]?(no|nr|num\w*))?$", re.I
)
TICK = re.compile(r"(^|[/_. ])(sys)?ticks?([_ ]?(count|counter|cnt))?$", re.IGNORECASE)
_MOTOR_STATE = re.compile(r"motor_?state", re.IGNORECASE)
"""The counter of milliseconds beside the motors' states of a robot by Unitree."""
_SECONDS = re.compile(r"^(.*?)(se[ck]s?|seconds|s)$", re.IGNORECASE)
_PARTS = dict.fromkeys(("nanosec", "nsec", "nsecs", "nanosecs", "nanosek", "nanoseconds", "ns"), 1e-09)
_PARTS |= dict.fromkeys(("microsec", "usec", "usecs", "microsecs", "mikrosek", "microseconds", "us"), 1e-06)
"""What the rest of a stamp is called, in whose name that of its seconds is changed, and what one of it is [s]."""
_MOSTLY = 0.05
"""Part of the rows whose time must come later for a column to be one; stamps of a coarse clock are held for many."""

_FAR_MORE_EVEN = 0.5
"""Unevenness over that of the clock with the plainest name, below which another clock is taken."""
PARTS_OF_SECONDS = {1e-9: " + 1e-9 ", 1e-6: " + 1e-6 ", 1e-3: " + 1e-3 "}
"""What stands between the names of two columns that are one time, by what one of the second is [s]."""
_RESTS = {
    re.compile(r"(time[_ ]?)?(ms|msecs?|millis|milliseconds?)", re.IGNORECASE): 1e-3,
    re.compile(r"(time[_ ]?)?(us|usecs?|micros|microseconds?)", re.IGNORECASE): 1e-6,
}
"""Names of a rest beside whole seconds, and what one of it is [s]."""
_GOES_ON = 0.99
"""Part of the steps that do not go back where seconds and their rest are one stamp."""

AT_RATE = " at "
"""Between the name of a counter of rows, if there is one, and their rate, where these are the time."""


class RowTimes(NamedTuple):
    """When the rows of a log were taken.

    Attributes:
        column: Its name, or those of seconds and of the rest with one of `PARTS_OF_SECONDS` between.
        unit: Of the column, by name.
        time: Since the first row [s]. Shape (n_rows,).
        begin: Of the first row since 1970, where the stamps are dates; else anything smaller [s].
    """

    column: str
    unit: str
    time: Samples
    begin: float = 0.0


def find_stamps(columns: Iterable[str]) -> list[str]:
    """Names of columns that are called as times, the plainest first; where none is, of those in a unit of time."""
    names = list(columns)
    called = [name for name in names if _is_time(name) and not says_steps(name)]
    if not called and any(_MOTOR_STATE.search(name) for name in names):
        called = [name for name in names if TICK.search(name)]
    called = called or [name for name in names if _TIME_UNIT.search(name) and read_column_name(name) is None]
    return sorted(called, key=lambda name: (len(name), name))


def _find_clocks_by_unit(columns: Mapping[str, Samples]) -> list[str]:
    """Names of columns that end in a part of a second and never go back: `mcu_us`, whatever else they are called."""
    ended = [name for name in columns if _ENDS_IN_UNIT.search(name) and read_column_name(name) is None]
    rising = (name for name in ended if not says_steps(name) and _rises(columns[name]))
    return [name for name in rising if np.all(np.diff(columns[name][np.isfinite(columns[name])]) >= 0.0)]


def _is_time(name: str) -> bool:
    """Whether a column is called as a time: `robot_time`, or `RobotTime` in one word."""
    name = make_narrow(name).replace("'", "")  # `/'Group'/'Time'`, as LabVIEW calls its channels
    return bool(_TIME.match(name) or _TIME.match(_WORD_BEGINS.sub("_", name)))


def says_steps(name: str) -> bool:
    """Whether a column is called as the time since the row before: `dt`, `delta_t_us`."""
    return _STEPS.match(name) is not None


def read_times(path: Path, columns: Mapping[str, Samples]) -> RowTimes:
    """The time of the rows, from the column that is called as one.

    Args:
        path: Of the file, for messages.
        columns: All columns by name; shape (n_rows,) each.

    Raises:
        RecordingError: No column is, or it holds no times.
    """
    rows = max(values.size for values in columns.values()) if columns else 0
    period = {name: values for name, values in columns.items() if values.size == 1 < rows and _PERIOD.match(name)}
    rates = {
        name: float(values[0]) for name, values in columns.items() if values.size == 1 < rows and _RATE.match(name)
    }
    columns = {name: values for name, values in columns.items() if name not in period and name not in rates}
    split = _find_split_stamp(columns)
    stamps = [*find_stamps(columns), *_find_clocks_by_unit(columns)]
    stamps = [name for name in dict.fromkeys(stamps) if split is None or name not in split]
    rate = read_head_facts(path).get("rate")
    replaced = split is not None or rate is not None
    stamps = [name for name in stamps if not replaced or np.isfinite(columns[name]).any()]
    if len(stamps) > 1:
        stamps = _prefer_even(columns, sorted(stamps, key=lambda name: not _rises(columns[name])))
    names = stamps
    if split is not None and not names:
        whole, rest, one = split
        seconds, parts = columns[whole], columns[rest]
        time = (seconds - seconds[0]) + one * (parts - parts[0])
        return RowTimes(f"{whole}{PARTS_OF_SECONDS[one]}{rest}", "s", time, float(seconds[0]))
    names = names or _find_epochs(columns)
    if not names and (ticks := _find_ticks(columns)):
        return _read_ticks(path, ticks[0], columns[ticks[0]])
    if not names:
        if period:
            return _count_rows(path, *period.popitem(), rows)
        steps = next((name for name in columns if says_steps(name) and _are_steps(columns[name])), "")
        if steps:
            _require_times(path, steps, columns[steps])
            unit = read_time_unit(steps) or guess_unit(np.cumsum(columns[steps]))
            return RowTimes(steps, unit, np.cumsum(columns[steps]) * find_unit(unit).factor)
        said = {rate.value} if rate is not None else {one for one in rates.values() if 0.0 < one < float("inf")}
        if len(said) == 1:
            return _count_stated(columns, said.pop(), rows)
        if all(read_column_name(name) is None for name in columns):
            raise RecordingError(_explain_nameless(path, columns))
        raise RecordingError(
            f"{path} has no column of time: its columns are {list_names(columns)}. Call it time [s], or give the "
            "rate of its rows: 'fricomp convert LOG --row-rate 500 --out joint.csv' where 500 rows come a second"
            f"{say_row_rate(columns)}"
        )
    time = columns[names[0]]
    finite = _require_times(path, names[0], time)
    unit = read_time_unit(names[0]) or guess_unit(finite)
    if unit == "s" and not read_time_unit(names[0]):
        require_slow(path, names[0], finite)
    since = np.asarray((time - finite[0]) * find_unit(unit).factor)
    return RowTimes(names[0], unit, since, find_date(float(finite[0]), unit))


def _are_steps(values: Samples) -> bool:
    """Whether no number of a column goes back in time, or is larger than any reading."""
    return bool(np.all(find_readings(values) & (values >= 0.0)))


def _count_rows(path: Path, name: str, period: Samples, rows: int) -> RowTimes:
    """The time of rows that come every so often, as a number beside them says."""
    each = np.full(rows, float(_require_times(path, name, np.repeat(period, 2))[0]))
    unit = read_time_unit(name) or guess_unit(np.cumsum(each))
    return RowTimes(name, unit, np.cumsum(each) * find_unit(unit).factor)


def _count_stated(columns: Mapping[str, Samples], rate: float, rows: int) -> RowTimes:
    """The time of rows by their rate, which stands above them: of a counter that numbers them, else one by one."""
    counters = (name for name, values in columns.items() if _COUNTER.search(name) and values.size == rows)
    name = next((one for one in counters if _numbers_rows(columns[one])), "")
    numbers = columns[name] if name else np.arange(rows, dtype=np.float64)
    return RowTimes(f"{name}{AT_RATE}{rate!r} Hz", "s", (numbers - numbers[0]) / rate)


def _numbers_rows(values: Samples) -> bool:
    """Whether whole numbers go on by one from row to row, but for rows that are missing."""
    steps = np.diff(values)
    return bool(np.all(np.isfinite(values)) and np.all(steps == np.round(steps)) and np.median(steps) == 1.0)


def _require_times(path: Path, name: str, values: Samples) -> Samples:
    """The times of a column that are finite; two are the least that say anything."""
    finite: Samples = values[np.isfinite(values)]
    if finite.size < 2:
        raise RecordingError(
            f"{path}: the column {name!r} holds no times that are read: write seconds, or dates such as "
            "2026-03-05T10:11:12.345"
        )
    return finite


def _find_epochs(columns: Mapping[str, Samples]) -> list[str]:
    """Names of columns of stamps since an epoch, however called: nothing else goes on so evenly so far from zero.

    The least even is the last.
    """
    finite = {name: values[np.isfinite(values)] for name, values in columns.items()}
    found = [
        name
        for name, stamps in finite.items()
        if _rises(stamps) and np.all(np.diff(stamps) >= 0.0) and find_epoch_unit(stamps, measure_step(stamps))
    ]
    return sorted(found, key=lambda name: _measure_unevenness(finite[name]))


def _find_ticks(columns: Mapping[str, Samples]) -> list[str]:
    """Names of counters that go on by more than one from row to row: parts of a second, and no numbers of rows."""
    named = {name: values[np.isfinite(values)] for name, values in columns.items() if TICK.search(name)}
    return [name for name, ticks in named.items() if _rises(ticks) and measure_step(ticks) > 1.0]


def _read_ticks(path: Path, name: str, ticks: Samples) -> RowTimes:
    """The time of rows by a counter of parts of a second: as many a second as stands above them, else in ms or us."""
    known = ticks[np.isfinite(ticks)]
    rate = read_head_facts(path).get("tick_rate")
    if rate is not None:
        return RowTimes(f"{name}{AT_RATE}{rate.value!r} Hz", "s", (ticks - known[0]) / rate.value)
    require_known_ticks(path, name, known)
    unit = guess_unit(known)
    return RowTimes(name, unit, np.asarray((ticks - known[0]) * find_unit(unit).factor))


def _explain_nameless(path: Path, columns: Mapping[str, Samples]) -> str:
    """What to do with columns none of whose names says what it holds."""
    if path.suffix.lower() == ".bin":
        return (
            f'{path} is bare numbers, which do not say how many columns they are: write format = "binary", dtype and '
            "columns under [source] of a mapping, and the channels below (docs/recordings.md), and give it by --mapping"
        )
    if not columns:
        return (
            f"{path} holds no columns of numbers under names: give a table, or an object, with a list of numbers for "
            "each of time, position and torque"
        )
    return (
        f"{path} has columns whose names do not say what they hold: {list_names(columns)}. Let 'fricomp convert {path} "
        "--inspect --out log.toml' propose a mapping by what the numbers do, correct it, and give it by --mapping "
        "log.toml"
    )


def _prefer_even(columns: Mapping[str, Samples], names: list[str]) -> list[str]:
    """The names with that first whose clock is far more even than that of the first, if there is one.

    A computer that receives the rows stamps them when it gets to it; the device's own clock is beside it.
    """
    rising = [name for name in names if _rises(columns[name])]
    if len(rising) < 2:
        return names
    uneven = {name: _measure_unevenness(columns[name]) for name in rising}
    best = min(rising, key=lambda name: uneven[name])
    if uneven[best] > _FAR_MORE_EVEN * uneven[rising[0]]:
        return names
    return [best, *(name for name in names if name != best)]


def _measure_unevenness(stamps: Samples) -> float:
    """Usual change from one step of a clock to the next, over the usual step: of rows as they came, or in its order.

    A computer that receives rows out of turn stamps them in turn all the same; the device's own clock sorts them.
    """
    known = stamps[np.isfinite(stamps)]
    return min(_compare_steps(np.diff(known)), _compare_steps(np.diff(np.sort(known))))


def _compare_steps(step: Samples) -> float:
    usual = float(np.mean(step)) if step.size else 0.0
    return float(np.mean(np.minimum(np.abs(np.diff(step)) / usual, 3.0))) if usual > 0.0 and step.size > 1 else np.inf


def _rises(values: Samples) -> bool:
    """Whether most of the rows come after the one before: a counter of cycles or a period does not."""
    steps = np.diff(values[np.isfinite(values)])
    return bool(steps.size) and float(np.mean(steps > 0.0)) > _MOSTLY


def _find_split_stamp(columns: Mapping[str, Samples]) -> tuple[str, str, float] | None:
    """The columns of whole seconds and of the rest that are one stamp, and what one of the rest is [s]."""
    lower = {name.lower(): name for name in columns}
    for name in columns:
        match = _SECONDS.match(name)
        found = [(lower.get(match.group(1).lower() + part), one) for part, one in _PARTS.items()] if match else []
        for rest, one in found:
            if rest is not None and rest != name and _is_rest(columns[name], columns[rest], one):
                return name, rest, one
    return _find_stamp_with_rest(columns)


def _find_stamp_with_rest(columns: Mapping[str, Samples]) -> tuple[str, str, float] | None:
    """A time in whole seconds and the column `ms` or `us` of their rest, which starts again with each of them."""
    rests = [(name, one) for name in columns for pattern, one in _RESTS.items() if pattern.fullmatch(name)]
    for rest, one in rests:
        for name in find_stamps(columns):
            if name == rest or not _is_rest(columns[name], columns[rest], one):
                continue
            both = columns[name] + one * columns[rest]
            known = both[np.isfinite(both)]
            if np.any(np.diff(columns[rest]) < 0.0) and np.mean(np.diff(known) >= 0.0) > _GOES_ON:
                return name, rest, one
    return None


def _is_rest(seconds: Samples, rest: Samples, one: float) -> bool:
    """Whether one column holds whole seconds that never go back for long, and the other parts of a second."""
    known = seconds[np.isfinite(seconds)]
    parts = rest[np.isfinite(rest)]
    if known.size < 2 or not parts.size or np.any(known != np.round(known)):
        return False
    return bool(parts.min() >= 0.0 and parts.max() * one < 1.0 and np.ptp(parts) > 0.0)
