"""From the named columns of a log to a recording of each joint in it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.finding import Finding
from fricomp.recording.metadata import RecordingMetadata, format_date
from fricomp.recording.recording import Recording
from fricomp.recording.runs import integrate, order_runs, sort_rows
from fricomp.recording.stamps import spread_held, with_row_rate
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import UNKNOWN_UNIT
from fricomp.recording.validity import Samples, drop_bad_rows, drop_twins, mend_stamps

from .choice import INTEGRAL, TORQUES, choose_columns
from .column import RAW_UNIT, ColumnMeaning, name_joint
from .degrees import read_wrapped_degrees, refuse_arm_in_degrees
from .device_unit import are_counts, explain_unit, find_rating_parts, refuse_axis
from .episodes import join_episodes
from .gear import GEARED, bring_to_joint, find_gear, is_motors_velocity, say_gear
from .head_fact import say_head_facts
from .head_offset import say_offsets
from .missing import explain_missing, say_left_out
from .quantity_files import is_quantity_folder, read_quantity_files
from .reference_unit import settle_references
from .sliding import is_linear, mark_assumed, require_length
from .source import read_named_columns
from .sparse import join_sparse
from .times.clock import AT_RATE, find_stamps, read_times
from .torque_size import say_torque_constant, say_torque_size
from .unstated import refuse_unstated, say_missing_unit, settle_units
from .vendor import find_drive_of_turns

_SURE = 3
"""Certainty of a column that the user chose, or whose vendor's unit is known."""
_REFERENCES = ("position_reference", "velocity_reference", "torque_command")


@dataclass(frozen=True)
class NamedLog:
    """What was read by names.

    Attributes:
        recordings: One a joint.
        sources: Column of each channel, by the joint's name in its recording; `time` is of all.
        notes: What was taken for what, and what was left out, in sentences.
        findings: Of all joints' rows.
        rows: Number of those of the file.
    """

    recordings: tuple[Recording, ...]
    sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
    notes: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    rows: int = 0


def read_named_log(path: Path, channels: Mapping[str, str] | None = None, *, row_rate: float | None = None) -> NamedLog:
    """A recording of each joint in a file whose columns say what they hold.

    Args:
        path: CSV or text with a line of names, Parquet, MAT, NPZ, JSON, MCAP, a bag, or a folder of a file a quantity.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.

    Raises:
        RecordingError: The file cannot be read, or does not say what its columns are.
        MissingExtraError: The package that reads the format is not installed.
    """
    found = (read_quantity_files(path) if is_quantity_folder(path) else {}) or read_named_columns(path)
    columns = join_episodes(found, row_rate)
    if row_rate is not None and columns.keys() == found.keys():
        stamps = find_stamps(columns)
        columns = with_row_rate({name: values for name, values in columns.items() if name not in stamps}, row_rate)
    return separate_joints(path, columns, channels or {})


def separate_joints(path: Path, columns: Mapping[str, Samples], channels: Mapping[str, str]) -> NamedLog:
    """One recording of each joint that has a position, or a velocity, and a torque or what stands for one.

    Args:
        path: Of the file, for messages.
        columns: All columns by name; shape (n_rows,) each.
        channels: As for `read_named_log`.

    Raises:
        RecordingError: The columns do not say where time, position or torque is.
    """
    asked = set(channels.values())  # `t` may be a torque
    column, unit, time, begin = read_times(
        path, {name: values for name, values in columns.items() if name not in asked}
    )
    chosen = choose_columns(path, columns, channels)
    moved = [joint for joint, own in chosen.items() if "position" in own]
    source = next((one for one in TORQUES if any(one in chosen[joint] for joint in moved)), "")
    complete = [joint for joint in moved if any(one in chosen[joint] for one in (source, *TORQUES[:2]))]
    if not complete:
        raise RecordingError(explain_missing(path, columns, chosen))
    notes: list[str] = []
    silent = [chosen[joint]["position"][1].joint for joint in moved if joint not in complete]
    if silent:
        notes.append(
            f"{path.name} has no torque of {', '.join(map(name_joint, silent))}: held as the simulation has it."
        )
    recordings: list[Recording] = []
    sources: dict[str, Mapping[str, tuple[str, ColumnMeaning]]] = {}
    findings: list[Finding] = []
    for joint in complete:
        own = chosen[joint]
        notes += _leave_out_unknown(path, own)
        recording, found = _build(path, time, columns, own)
        notes += [f"{path.name}, {recording.metadata.joint}: {finding.message}." for finding in found]
        ratio = find_gear(recording, own)
        notes += say_gear(path, ratio, own)
        if abs(ratio) > GEARED and is_motors_velocity(recording, own):
            kept = {name: values for name, values in recording.channels.items() if name != "velocity"}
            recording = Recording.from_channels(kept, recording.metadata)
            notes.append(f"{path.name}: {own.pop('velocity')[0]!r} is that of the motor, and was left out.")
        recording, of_motor = bring_to_joint(path, recording, ratio, own)
        notes += of_motor
        findings += found
        recording, settled = settle_units(path, recording, own, (column, unit))
        recording, followed = settle_references(path, recording, own)
        notes += [*settled, *followed]
        recording = recording.with_metadata(recorded=format_date(begin))
        recordings.append(mark_assumed(recording, own))
        refuse_unstated(path, recording, own)
        sources[recording.metadata.joint] = {"time": (column, ColumnMeaning("time", "", 0, unit)), **own}
    refuse_arm_in_degrees(path, recordings, sources)
    _ask_turns(path, columns, sources)
    first = recordings[0].metadata
    if first.torque_unit == "A":
        notes += say_torque_constant(path, columns, sources[first.joint]["torque"])
    notes += say_torque_size(path, recordings[0], sources[first.joint])
    notes += [_say_columns(path, recordings, sources), *say_offsets(path)]
    notes += say_left_out(path, columns, sources)
    unsaid = [say_missing_unit(path, one, sources[one.metadata.joint], len(recordings)) for one in recordings]
    notes += unsaid[0]
    return NamedLog(tuple(recordings), sources, tuple(notes), tuple(findings), time.size)


def _build(
    path: Path, time: Samples, columns: Mapping[str, Samples], own: dict[str, tuple[str, ColumnMeaning]]
) -> tuple[Recording, tuple[Finding, ...]]:
    """The recording of a joint, and what is said of its rows; a current stands in for a torque that is not there."""
    joint, linear = own["position"][1].joint, is_linear(own)
    unit = "N" if linear else "N·m"
    stands_in = next(one for one in TORQUES if one in own)
    own["torque"] = own[stands_in]
    if stands_in == "current" or own["torque"][1].unit in ("A", "mA"):
        unit = "A"
    elif own["torque"][1].unit in ("V", "mV"):
        unit = "V"
    table, wrapped = {"time": time, **_to_si(path, columns, own, time.size)}, tuple[Finding, ...]()
    require_length(path, own["position"], table.get("position", time[:1]))
    if own["position"][0] == INTEGRAL:
        table["position"] = table["velocity"]
    elif read_wrapped_degrees(table, own):
        wrapped = (
            Finding("degrees", "note", "position goes round at 360: it was taken to be in degrees", "nothing to do"),
        )
    elif not linear:
        refuse_axis(path, *own["position"], table["position"])
    table = _leave_out_empty(join_sparse(table))
    for channel in [one for one in own if one not in table and own[one][0] != INTEGRAL]:
        del own[channel]
    usable, findings = _mend_rows(table)
    findings = wrapped + findings
    if own["position"][0] == INTEGRAL:
        usable["position"] = integrate(usable["position"], usable["time"])  # the velocity, until here
    if usable["time"].size < 2:
        if not findings:
            raise RecordingError(f"{path} has fewer than two rows with both a position and a torque: record longer")
        raise RecordingError(
            f"{path}: {findings[0].message}; say --row-rate to fricomp convert where stamps are held or missing"
        )
    metadata = RecordingMetadata(
        joint=name_joint(joint) if joint else RecordingMetadata().joint,
        motion="linear" if linear else "rotary",
        torque_unit=unit,
        torque_kind="commanded" if stands_in == "torque_command" else RecordingMetadata().torque_kind,
        source=path.name,
    )
    return Recording.from_channels(usable, metadata), findings


def _mend_rows(table: dict[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """The rows in their order and with a time that goes on, and what was done to them."""
    findings: tuple[Finding, ...] = ()
    for mend in (drop_twins, sort_rows, order_runs, spread_held, mend_stamps, drop_bad_rows):
        table, told = mend(table)
        findings += told
    return table, findings


def _leave_out_unknown(path: Path, own: dict[str, tuple[str, ColumnMeaning]]) -> list[str]:
    """Take the columns off that are not needed and whose unit is not known; what is said of each."""
    needed = {"position", "motor_position", next(one for one in TORQUES if one in own)}
    needed |= {"velocity"} if own.get("position", ("", None))[0] == INTEGRAL else set()
    unknown = [one for one in own if one not in needed and own[one][1].unit in (RAW_UNIT, UNKNOWN_UNIT)]
    return [
        f"{path.name}: {own.pop(channel)[0]!r} was left out, because the worth of its unit is not known; say it in a "
        "mapping, by scale, where it is wanted."
        for channel in unknown
    ]


def _to_si(
    path: Path, columns: Mapping[str, Samples], own: Mapping[str, tuple[str, ColumnMeaning]], rows: int
) -> dict[str, Samples]:
    """The channels of a joint that have a column, in SI.

    Raises:
        RecordingError: A column is in units of a device, or has not one value a row.
    """
    table = {}
    # A rating first: what is to be written of it asks for the other columns as well; a command may be the torque.
    order = sorted(own.items(), key=lambda one: (not find_rating_parts(one[1][0], columns), one[0] == "torque_command"))
    for channel, (column, meaning) in order:
        if column == INTEGRAL:
            continue
        unknown = explain_unit(path, channel, column, meaning, columns)
        if unknown:
            raise RecordingError(unknown)
        found = find_unit(meaning.unit) if meaning.unit else None
        values = columns[column]
        if channel == "torque" and are_counts(column, values):
            asked = (
                f"{path}: {column!r} holds whole numbers alone and names no unit: counts of a register, or parts of a "
                f"rating? Say in a mapping what one is worth, such as torque = {{ column = {column!r}, scale = "
                "VALUE_OF_ONE }, 1.0 where they are amperes or N·m ('fricomp convert LOG --inspect --out log.toml' "
                "begins one)"
            )
            raise RecordingError(say_head_facts(path, asked, column, columns))
        if values.size != rows:
            raise RecordingError(f"{path}: {column!r} has {values.size} rows, and the time {rows}")
        converts = found is not None and (found.factor, found.offset) != (1.0, 0.0)
        values = values if meaning.scale == 1.0 else values * meaning.scale
        table[channel] = values * found.factor + found.offset if found and converts else values
    return table


def _leave_out_empty(table: dict[str, Samples]) -> dict[str, Samples]:
    """Channels that are needed, and the others where they have a number in nearly every row with a position.

    A reference that never changes while the joint moves is none: its loop follows another one.
    """
    said = np.isfinite(table["position"]) & np.isfinite(table["torque"])
    needed = ("time", "position", "torque")
    return {
        name: values if said.all() else values[said]
        for name, values in table.items()
        if name in needed
        or (
            np.count_nonzero(np.isfinite(values[said])) > 0.99 * np.count_nonzero(said)
            and not (name in _REFERENCES and np.ptp(values[said]) == 0.0 and np.ptp(table["position"][said]) > 0.0)
        )
    }


def _say_column(channel: str, column: str, meaning: ColumnMeaning, recording: Recording) -> str:
    """What a column was taken for; without a unit in its name in that of SI."""
    if column == INTEGRAL:
        return f"{channel} from the integral of velocity, so that gravity and cogging are told from no zero"
    if column.startswith(AT_RATE):
        return f"{channel} of the rows{column}"
    unit = meaning.unit and f" in {meaning.unit}"
    return f"{channel} {column!r}{unit or _as_si(channel, recording)}"


def _as_si(channel: str, recording: Recording) -> str:
    """The unit of SI that a column without one in its name is taken in."""
    unit = {"position": recording.metadata.position_unit, "torque": recording.metadata.torque_unit}.get(channel)
    return f" as {unit}" if unit else ""


def _ask_turns(
    path: Path, columns: Mapping[str, Samples], sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
) -> None:
    """Refuse to take for rad what is called as a drive calls its turns.

    Raises:
        RecordingError: Some position is, and states no unit.
    """
    for own in sources.values():
        column, meaning = own["position"]
        drive = "" if meaning.unit or meaning.certainty >= _SURE else find_drive_of_turns(column, columns)
        if drive:
            raise RecordingError(
                f"{path}: {column!r} states no unit, and the columns are called as those of {drive}, which writes "
                f'turns: say position = {{ column = {column!r}, unit = "turns" }} in a mapping, velocity in '
                f"\"turns/s\" ('fricomp convert LOG --inspect --out log.toml' begins one), or --channel "
                f"position={column} where it is in rad"
            )


def _say_columns(
    path: Path, recordings: Sequence[Recording], sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
) -> str:
    """One sentence on what was taken for what, with the units that names state."""
    first = recordings[0]
    said = [
        _say_column(channel, column, meaning, first)
        for channel, (column, meaning) in sources[first.metadata.joint].items()
        if channel in first.channels
    ]
    whose = f"{len(recordings)} joints; of the first, " if len(recordings) > 1 else "by the names of its columns, "
    return f"{path.name}: {whose}{', '.join(said)}."
