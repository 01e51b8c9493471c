"""Which column of a log is which channel of which joint, by the names and by what the user says of them."""

import re
import shlex
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.quantity_word import split_words
from fricomp.recording.recording import CHANNELS
from fricomp.recording.unit_word import find_unit_words, unit_for
from fricomp.recording.validity import Samples

from .column import (
    REPEATED,
    ColumnMeaning,
    find_bare_unit,
    name_joint,
    read_column_name,
    read_column_unit,
    simplify_joint,
    without_observation,
)
from .device_unit import is_duty, with_unit_step
from .joints.control_path import take_controls
from .joints.joint_path import Candidates, is_complete, separate_paths
from .joints.shared_rest import read_currents, read_shared_rests
from .joints.two_encoders import pair_encoders
from .position_by_rate import find_position_by_rate, is_rate_of
from .units.several_units import are_one_quantity
from .vendor import read_vendor_name, with_vendor_unit

Chosen = dict[str, dict[str, tuple[str, ColumnMeaning]]]
"""Column and its meaning, by what is left of the column's name for the joint, and by channel."""

_NUMBERED_MOTOR = re.compile(r"(?<![A-Za-z])motor[_ ]?\[?\d", re.IGNORECASE)
_REPEATED = re.compile(rf"{REPEATED}\d+$")
INTEGRAL = ""
"""Name of the column of a position that is the integral of the velocity."""
_WINDING = frozenset(["motor", "rotor", "winding", "coil", "stator", "wicklung"])
"""Words of a motor's own temperature."""
_ELSEWHERE = frozenset(
    ["ambient", "room", "air", "environment", "board", "pcb", "mos", "mosfet", "fet", "driver", "mcu", "cpu"]
)
"""Words of a temperature that is none of the motor's."""
_TORQUE_AXIS = frozenset(["iq", "iqf", "q"])
"""Words of the current that makes the torque, among those of other axes and phases."""
TORQUES = ("torque", "current", "load_torque", "torque_command")
"""What may stand for the torque, in this order."""


def choose_columns(path: Path, columns: Mapping[str, Samples], channels: Mapping[str, str]) -> Chosen:
    """The columns of each joint that has a position, or a velocity where nothing has one.

    Args:
        path: Of the file, for messages.
        columns: All columns by name; shape (n_rows,) each.
        channels: Column by channel where several could be one.

    Raises:
        RecordingError: A column that was asked for is missing, or two could be the same.
    """
    candidates = take_controls(_drop_shared_words(_find_candidates(path, columns, channels)))
    wanted = _with_temperature(candidates, _choose_joints(candidates))
    chosen = {
        joint: _without_duty({channel: _choose_one(path, channel, own, columns) for channel in own})
        for joint, own in wanted.items()
    }
    taken = {name for own in candidates.values() for found in own.values() for name, _ in found}
    chosen = _with_rate(columns, {joint: _with_position(columns, own, taken) for joint, own in chosen.items()})
    return _share_position(columns, chosen)


def list_names(names: Iterable[str]) -> str:
    """The first names of many."""
    names = list(names)
    return ", ".join(names[:20]) + (" …" if len(names) > 20 else "")


def _find_candidates(path: Path, columns: Mapping[str, Samples], channels: Mapping[str, str]) -> Candidates:
    candidates: Candidates = {}
    unknown = sorted(set(channels) - set(CHANNELS))
    if unknown:
        raise RecordingError(f"there is no channel {unknown[0]!r} for --channel: valid are {', '.join(CHANNELS)}")
    asked = {name: meaning for name in columns for meaning in [_match_asked(name, channels)] if meaning}
    missing = sorted(set(channels) - {meaning.channel for meaning in asked.values()})
    if missing:
        raise RecordingError(
            f"{path} has no column {channels[missing[0]]!r} for --channel {missing[0]}: it has {list_names(columns)}"
        )
    known = {
        name: meaning for name in columns if (meaning := read_vendor_name(name, columns) or read_column_name(name))
    }
    known = pair_encoders(known | read_shared_rests(columns))
    known = _take_numbered_motors(known) | read_currents(columns, known) | asked
    _refuse_repeated(path, known, channels)
    known = {name: meaning for name, meaning in known.items() if name in asked or not _REPEATED.search(name)}
    by_word = {meaning.channel for meaning in known.values()}
    rows = max((values.size for values in columns.values()), default=0)
    for name, values in columns.items():
        if values.size == 1 < rows:
            continue  # a fact beside the columns, such as a number of dimensions
        meaning = known.get(name) or (None if _REPEATED.search(name) else _read_by_unit(name, by_word))
        if meaning is None or (meaning.channel in channels and name not in asked) or not np.isfinite(values).any():
            continue
        meaning = with_unit_step(name, with_vendor_unit(name, meaning, columns), values)
        own = candidates.setdefault(simplify_joint(meaning.joint), {})
        own.setdefault(meaning.channel, []).append((name, meaning))
    return {joint: own for each in candidates.items() for joint, own in separate_paths(*each).items()}


def _take_numbered_motors(known: Mapping[str, ColumnMeaning]) -> dict[str, ColumnMeaning]:
    """The columns with `motor1_pos` as the position of a joint, where nothing is called a position without such a word.

    A number behind tells one actuator from others, and not a motor from its joint.
    """
    if any(meaning.channel == "position" for meaning in known.values()):
        return dict(known)
    return {
        name: replace(meaning, channel="position") if _is_numbered_motor(name, meaning) else meaning
        for name, meaning in known.items()
    }


def _is_numbered_motor(name: str, meaning: ColumnMeaning) -> bool:
    return meaning.channel == "motor_position" and _NUMBERED_MOTOR.search(name) is not None


def _drop_shared_words(candidates: Candidates) -> Candidates:
    """Joints without the words that stand in the names of all of a channel, where no joint is complete with them.

    Beside `q_1` and `q_2`, `motor_torque_1` and `motor_torque_2` are of 1 and 2: what all say tells none from another.
    """
    if any(is_complete(own) for own in candidates.values()):
        return candidates
    called: dict[str, list[list[str]]] = {}
    for joint, own in candidates.items():
        for channel in own:
            called.setdefault(channel, []).append(joint.split("_"))
    shared = {channel: set(names[0]).intersection(*names) for channel, names in called.items() if len(names) > 1}
    dropped: Candidates = {}
    for joint, own in candidates.items():
        for channel, found in own.items():
            left = "_".join(word for word in joint.split("_") if word not in shared.get(channel, ()))
            named = [(name, replace(meaning, joint=left)) for name, meaning in found]
            dropped.setdefault(left, {}).setdefault(channel, []).extend(named)
    return dropped if sum(map(is_complete, dropped.values())) > 1 else candidates


def _refuse_repeated(path: Path, known: Mapping[str, ColumnMeaning], channels: Mapping[str, str]) -> None:
    """Refuse a log in which several columns are called alike that differ, and are needed.

    Raises:
        RecordingError: It is not said which of them is meant.
    """
    for name, meaning in known.items():
        if not _REPEATED.search(name) or meaning.channel in channels or meaning.channel not in ("position", "torque"):
            continue
        called = _REPEATED.sub("", name)
        alike = [one for one in known if _REPEATED.sub("", one) == called]
        said = " or ".join(f"--channel {shlex.quote(f'{meaning.channel}={one}')}" for one in alike)
        raise RecordingError(
            f"{path}: {len(alike)} columns are called {called!r} and hold other numbers: say which is "
            f"meant, counted from the left, by {said}"
        )


def _read_by_unit(name: str, by_word: Collection[str]) -> ColumnMeaning | None:
    """What the unit in a name says, where the words of no column say which is that channel."""
    meaning = read_column_unit(name)
    if meaning is None or meaning.channel in by_word:
        return None
    return None if meaning.channel == "current" and "torque" in by_word else meaning


def _match_asked(name: str, channels: Mapping[str, str]) -> ColumnMeaning | None:
    """What a column is by what the user said of it."""
    for channel, wanted in channels.items():
        pattern = re.escape(wanted).replace(re.escape("{joint}"), "(.+)")
        pattern = pattern if "{joint}" in wanted else f"{pattern}(?:[:_.\\[]?(\\d+)\\]?|\\.(.+))?"
        match = re.fullmatch(pattern, name)
        if match:
            meaning = read_column_name(name)
            joint = next(filter(None, match.groups()), "")
            if joint and "{joint}" not in wanted:  # of the columns beside it, `observation.effort:3`
                joint = "_".join([*without_observation(wanted).split(".")[:-1], joint])
            said = find_unit_words(name, -1)
            unit = unit_for(channel, said[0].unit) if said else ""
            unit = meaning.unit if meaning else unit
            bare = find_bare_unit(name) if channel == "torque" else ""
            return ColumnMeaning(channel, joint, 3, bare or unit)
    return None


def _choose_joints(candidates: Candidates) -> Candidates:
    """The joints that are meant: those with names of their own; of one joint alone the columns may name none."""
    named = {joint: own for joint, own in candidates.items() if joint and "position" in own}
    if any(is_complete(own) for own in named.values()):
        return named
    alone = candidates.get("", {})
    if is_complete(alone):
        return {"": alone}
    for channel in ("position", "motor_position", "velocity"):
        moved = [joint for joint, own in candidates.items() if channel in own]
        if len(moved) == 1:
            return {moved[0]: _gather(candidates, moved[0])}
        if moved:
            return {joint: candidates[joint] for joint in moved}
    return {}


def _gather(candidates: Candidates, joint: str) -> dict[str, list[tuple[str, ColumnMeaning]]]:
    """All channels of the only joint that moves: what its columns do not have is taken from those of other names."""
    own = dict(candidates[joint])
    for other, channels in candidates.items():
        for channel, found in channels.items():
            if other != joint and channel not in candidates[joint]:
                own[channel] = own.get(channel, []) + found
    return own


def _with_temperature(candidates: Candidates, wanted: Candidates) -> Candidates:
    """The joint with the motor's temperature, where there is one alone: `Motortemperatur`, `temp_c`, `temp_motor`.

    Of several the one that is called as a motor's is meant; that of a room or of electronics says nothing of friction.
    """
    if len(wanted) != 1 or any("temperature" in own for own in wanted.values()):
        return wanted
    found = [one for own in candidates.values() for one in own.get("temperature", ())]
    said = [{word for word, _ in split_words(name)} for name, _ in found]
    warm = [one for one, words in zip(found, said, strict=True) if not words & _ELSEWHERE]
    own = [one for one, words in zip(found, said, strict=True) if words & _WINDING]
    ((joint, channels),) = wanted.items()
    (best,) = own if len(own) == 1 else warm if len(warm) == 1 else (None,)
    return wanted if best is None else {joint: channels | {"temperature": [best]}}


def _choose_one(
    path: Path,
    channel: str,
    own: Mapping[str, Sequence[tuple[str, ColumnMeaning]]],
    columns: Mapping[str, Samples],
) -> tuple[str, ColumnMeaning]:
    """The column that says the most surely that it was measured; of currents that which makes the torque."""
    most = max(meaning.certainty for _, meaning in own[channel])
    best = [one for one in own[channel] if one[1].certainty == most]
    if channel == "current":
        best = [one for one in best if _TORQUE_AXIS & {word for word, _ in split_words(one[0])}] or best
    stands_in = channel == "current" and "torque" not in own
    if len(best) > 1 and are_one_quantity([(columns[name], meaning.unit) for name, meaning in best]):
        return min(best, key=lambda one: one[1].unit != "")
    if len(best) > 1 and (channel in ("position", "torque") or stands_in):
        joint = best[0][1].joint
        whose = f" of joint {name_joint(joint)}" if joint and len({one.joint for _, one in best}) == 1 else ""
        raise RecordingError(
            f"{path}: {' and '.join(repr(name) for name, _ in best)} could each be the {channel}{whose}: choose by "
            f"--channel {'torque' if stands_in else channel}=NAME"
        )
    return best[0]


def _without_duty(own: dict[str, tuple[str, ColumnMeaning]]) -> dict[str, tuple[str, ColumnMeaning]]:
    """Column and meaning by channel without a duty cycle for a torque, where another column stands for one."""
    is_needless = "torque" in own and is_duty(own["torque"][0]) and any(one in own for one in TORQUES[1:])
    return {channel: one for channel, one in own.items() if not (is_needless and channel == "torque")}


def _with_position(
    columns: Mapping[str, Samples], own: dict[str, tuple[str, ColumnMeaning]], taken: Collection[str]
) -> dict[str, tuple[str, ColumnMeaning]]:
    """With what the velocity is the rate of, or its integral, where nothing is called a position or a motor's.

    Args:
        columns: All by name.
        own: Column and meaning of a joint by channel.
        taken: Names of columns that say what they hold.
    """
    if "position" in own or "motor_position" in own or "velocity" not in own:
        return own
    velocity, meaning = own["velocity"]
    column = find_position_by_rate(columns, velocity, taken) or INTEGRAL
    said = find_unit_words(column, -1)
    unit = unit_for("position", said[0].unit) if said else ""
    return {"position": (column, ColumnMeaning("position", meaning.joint, 0, unit)), **own}


def _with_rate(columns: Mapping[str, Samples], chosen: Chosen) -> Chosen:
    """The only joint with a velocity that its unit alone tells, `rate [deg/s]`, where its position has that rate."""
    if len(chosen) != 1 or "velocity" in next(iter(chosen.values())) or "position" not in next(iter(chosen.values())):
        return chosen
    ((joint, own),) = chosen.items()
    meanings = {name: read_column_unit(name) for name in columns}
    found = [name for name, one in meanings.items() if one is not None and one.channel == "velocity"]
    found = [name for name in found if is_rate_of(columns[name], columns.get(own["position"][0], columns[name]))]
    meaning = meanings[found[0]] if len(found) == 1 else None
    return chosen if meaning is None else {joint: own | {"velocity": (found[0], meaning)}}


def _share_position(columns: Mapping[str, Samples], chosen: Chosen) -> Chosen:
    """Joints at rest, whose velocity tells no position, with that of the list in which another joint's was found.

    `observation.state.wrist`, where `observation.velocity.elbow` is the rate of `observation.state.elbow`.
    """
    lists = dict[str, str]()
    for own in chosen.values():
        position, velocity = (own[channel][0] if channel in own else "" for channel in ("position", "velocity"))
        same = next((k for k, (a, b) in enumerate(zip(position[::-1], velocity[::-1], strict=False)) if a != b), 0)
        if same and position != INTEGRAL and own["position"][1].certainty == 0:
            lists[velocity[:-same]] = position[:-same]
    return {joint: own | _take_from_list(columns, own, lists) for joint, own in chosen.items()}


def _take_from_list(
    columns: Mapping[str, Samples], own: Mapping[str, tuple[str, ColumnMeaning]], lists: Mapping[str, str]
) -> dict[str, tuple[str, ColumnMeaning]]:
    """The position of a joint in the list that goes with that of its velocity; empty where it has one, or none is."""
    if "position" not in own or own["position"][0] != INTEGRAL:
        return {}
    velocity = own["velocity"][0]
    found = [to + velocity[len(rate) :] for rate, to in lists.items() if velocity.startswith(rate)]
    return {"position": (found[0], own["position"][1])} if found and found[0] in columns else {}
