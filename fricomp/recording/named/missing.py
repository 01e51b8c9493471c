"""What to write where the columns of a log do not say what a joint needs."""

import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.likely_torque import find_likely_torque
from fricomp.recording.sources.can_frames import refuse_bytes
from fricomp.recording.sources.reader import is_text
from fricomp.recording.unit_word import find_unit_words, kind_of_unit
from fricomp.recording.validity import Samples

from .choice import TORQUES, Chosen, list_names
from .column import RAW_UNIT, ColumnMeaning, read_column_name, read_column_unit
from .head_fact import say_head_facts
from .position_by_rate import is_rate_of
from .source import read_first_lines
from .times.clock import find_stamps, read_times

_PHASE = re.compile(r"(?:^|[_./ ])(?:[iI]|[Pp]hase|[Cc]urrent)[_ ]?([abcuvwABCUVW])(?![A-Za-z])")
"""Name of the current of a phase: `i_a`, `phase_u`, `motor.current_C [A]`."""
_ADDS_UP = 0.1
"""Deviation of the sum of three currents, in that of each, up to which they are those of three phases."""
_MOST_LEFT_OUT = 6
"""Columns that were not used, of which so many are named."""
_MOST_TRIED = 12
"""Columns of which each is tried as a torque."""
_FIRST_ROWS = 4
"""Rows in which bytes in hexadecimal are looked for."""


def explain_missing(path: Path, columns: Mapping[str, Samples], chosen: Chosen) -> str:
    """What the columns do not say, and what to write."""
    motors = [own["motor_position"] for own in chosen.values() if "motor_position" in own and "position" not in own]
    if motors:
        return say_head_facts(path, _explain_motor(path, *motors[0]))
    phases = _find_phases(columns)
    if phases:
        return (
            f"{path}: {' and '.join(phases)} are the currents of a motor's phases, which turn with its angle: log the "
            "current that makes the torque, such as iq, or a torque"
        )
    missing = "torque" if any("position" in own for own in chosen.values()) else "position"
    what = {"torque": "the torque", "position": "a position and a torque"}[missing]
    if missing == "position" and _has_torque(columns):
        what = "the position"
    said = {name: read_column_name(name) or read_column_unit(name) for name in columns}
    silent = [name for name, values in columns.items() if said[name] is None and _varies(values)]
    silent = [name for name in silent if not (_goes_on(columns[name]) and name in find_stamps(columns))]  # `T` may not
    silent = [name for name in silent if not _rises_evenly(columns[name])]
    silent = [name for name in silent if not _is_of_another(name, missing)]
    silent = [name for name in silent if missing != "torque" or not _is_velocity(columns, chosen, name)]
    likely = _choose_likely(path, columns, chosen, silent) if missing == "torque" else silent[0] if silent else ""
    likely = likely.partition(":")[0]
    such = (
        f", such as --channel {shlex.quote(f'{missing}={likely}')} where it is that one,"
        if likely and "and" not in what
        else ","
    )
    if path.is_file() and is_text(path):
        refuse_bytes(path, read_first_lines(path, _FIRST_ROWS).rows)
    both = " --channel torque=NAME" if "and" in what else ""
    return (
        f"{path} does not say where {what} of a joint is: its columns are {list_names(columns)}. Name them such as q_1 "
        f"and tau_1, say it by --channel {missing}=NAME{both}{such} or give a --mapping ('fricomp convert {path} "
        "--inspect' has one to edit)"
    )


def _choose_likely(path: Path, columns: Mapping[str, Samples], chosen: Chosen, silent: Sequence[str]) -> str:
    """Of columns whose names say nothing that which a joint explains as its torque; else the first."""
    position = next((own["position"][0] for own in chosen.values() if "position" in own), "")
    try:
        time = read_times(path, columns).time
    except RecordingError:
        return silent[0] if silent else ""
    if position not in columns or not _are_known(time, columns[position]):
        return silent[0] if silent else ""
    tried = {name: columns[name] for name in silent[:_MOST_TRIED] if _are_known(time, columns[name])}
    return find_likely_torque(time, columns[position], tried).name or (silent[0] if silent else "")


def _are_known(time: Samples, values: Samples) -> bool:
    """Whether a column has a number in each row."""
    return values.size == time.size and bool(np.isfinite(values).all())


def _explain_motor(path: Path, name: str, meaning: ColumnMeaning) -> str:
    """What to write of a motor's position where the joint has none of its own."""
    if meaning.unit == RAW_UNIT:
        return (
            f"{path} has the position of a motor alone, {name!r}, in units of a device: write position = {{ column = "
            f"{name!r}, scale = 6.2832/(COUNTS_A_TURN*RATIO) }} in a mapping with the number worked out, RATIO 1 where "
            "there is no gear, and scale = RATIO for a motor's torque (docs/recordings.md)"
        )
    unit = f', unit = "{meaning.unit}"' if meaning.unit else ""
    return (
        f"{path} has the position of a motor alone, {name!r}: say --channel {shlex.quote(f'position={name}')} where "
        f"there is no gear; else write position = {{ column = {name!r}{unit}, scale = 1/RATIO }} in a mapping with "
        "the number worked out, and scale = RATIO for a motor's torque ('fricomp convert LOG --inspect --out log.toml' "
        "begins one)"
    )


def _is_velocity(columns: Mapping[str, Samples], chosen: Chosen, name: str) -> bool:
    """Whether a column is the rate of a position that is known, and so no torque."""
    positions = [columns[own["position"][0]] for own in chosen.values() if own.get("position", ("",))[0] in columns]
    return any(is_rate_of(columns[name], position) for position in positions)


def _find_phases(columns: Mapping[str, Samples]) -> list[str]:
    """Names of the currents of three phases, which add up to nothing; none where there are no such."""
    names = [name for name in columns if _PHASE.search(name)]
    if len(names) != 3 or len({columns[name].size for name in names}) > 1:
        return []
    currents = np.stack([columns[name] for name in names])
    total, each = np.nanstd(np.nansum(currents, axis=0)), np.nanstd(currents)
    return names if total < _ADDS_UP * each else []


def _is_of_another(name: str, missing: str) -> bool:
    """Whether a column states a unit, and that of another quantity than the one that is missing."""
    said = find_unit_words(name, -1)
    kind = kind_of_unit(said[0].unit) if said else ""
    return kind not in ("", missing) and (missing, kind) not in (("torque", "current"), ("torque", "voltage"))


def _has_torque(columns: Mapping[str, Samples]) -> bool:
    """Whether the name of a column says that it is a torque, or stands for one."""
    meanings = [read_column_name(name) for name in columns]
    return any(meaning is not None and meaning.channel in TORQUES for meaning in meanings)


def _varies(values: Samples) -> bool:
    finite = values[np.isfinite(values)]
    return finite.size > 1 and bool(np.ptp(finite) > 0.0)


def _goes_on(values: Samples) -> bool:
    """Whether the known numbers of a column never fall. Shape (n_rows,)."""
    return bool(np.all(np.diff(values[np.isfinite(values)]) >= 0.0))


def _rises_evenly(values: Samples) -> bool:
    """Whether a column rises by the same from row to row. Shape (n_rows,)."""
    return values.size > 1 and bool(np.all(np.diff(values) == values[1] - values[0]))


def say_left_out(
    path: Path, columns: Mapping[str, Samples], sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
) -> list[str]:
    """Which columns of a log of one joint were not used, those first that are called as a quantity: one may be missed.

    Args:
        path: Of the file, for messages.
        columns: All by name.
        sources: Column and meaning by joint and channel.
    """
    if len(sources) != 1:
        return []
    taken = {name for own in sources.values() for name, _ in own.values()}
    left = [name for name, values in columns.items() if isinstance(name, str) and name not in taken and values.size > 1]
    changing = [name for name in left if np.ptp(np.nan_to_num(columns[name])) > 0.0]
    told = sorted(changing, key=lambda name: read_column_name(name) is None)[:_MOST_LEFT_OUT]
    if not told:
        return []
    more = f" and {len(changing) - len(told)} more" if len(changing) > len(told) else ""
    return [f"{path.name}: not used: {', '.join(map(repr, told))}{more}; --channel CHANNEL=NAME takes one."]
