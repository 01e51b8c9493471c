"""From a foreign file to recordings, as a mapping says."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording.checks.register import read_signed
from fricomp.recording.finding import Finding
from fricomp.recording.mapping import ChannelRule, Column, FileRule, JointRule, Mapping
from fricomp.recording.metadata import RecordingMetadata, format_date, metadata_from_fields
from fricomp.recording.named.wanted import read_wanted
from fricomp.recording.recording import CHANNELS, Recording
from fricomp.recording.resampling import resample_checked
from fricomp.recording.runs import integrate, order_runs, sort_rows
from fricomp.recording.sources import Columns, find_column
from fricomp.recording.stamps import spread_stamps
from fricomp.recording.unit import find_unit
from fricomp.recording.validity import Samples, drop_twins, find_usable_rows, mend_stamps, tell_bad_rows

_UNNAMED = "recording"
_SI = {
    "time": ("s", "s"),
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "acceleration": ("rad/s²", "m/s²"),
    "temperature": ("°C", "°C"),
    "current": ("A", "A"),
    "position_reference": ("rad", "m"),
    "velocity_reference": ("rad/s", "m/s"),
    "motor_position": ("rad", "m"),
    "housing_temperature": ("°C", "°C"),
    "supply_voltage": ("V", "V"),
}


@dataclass(frozen=True)
class NamedRecording:
    """A recording and its name in the set it comes from: "file", "joint" or "file/joint".

    Attributes:
        name: That name.
        recording: The recording.
        findings: Of its source, which the recording does not show any more (rows that were left out, what the checks
            found before it was resampled), and its own, where it was checked.
    """

    name: str
    recording: Recording
    findings: tuple[Finding, ...] = ()

    @property
    def faults(self) -> tuple[Finding, ...]:
        """The findings for which it cannot be used."""
        return tuple(one for one in self.findings if one.severity == "error")


@dataclass(frozen=True)
class _Plan:
    """Everything the mapping says about one recording."""

    name: str
    joint: JointRule
    joint_number: int
    file: FileRule
    channels: dict[str, ChannelRule]
    metadata: RecordingMetadata

    def key(self, column: Column, step: int = 0) -> Column:
        """Name or number of a source column for this joint."""
        if isinstance(column, int):
            return column + step * self.joint_number
        return column.replace("{joint}", self.joint.source or self.joint.name)


def convert(path: str | Path, mapping: Mapping) -> tuple[NamedRecording, ...]:
    """Return the recordings that a mapping finds in a source, in the order of the mapping.

    Args:
        path: File, the folder of a rosbag2, or a folder of files that the mapping knows; where it names none, all files
            in it of the usual kind are read alike, and each is called as its file is.
        mapping: What is where; see `load_mapping`.

    Raises:
        RecordingError: The source cannot be read, lacks a column, or holds samples that
            cannot be used; the message names row, column and what to do.
        MissingExtraError: The package that reads the format is not installed.
    """
    path = Path(path)
    if path.is_dir() and not (path / "metadata.yaml").is_file() and path.name not in _list_known(mapping):
        return _convert_folder(path, mapping)
    plans = _plan(mapping, path)
    keys = dict.fromkeys(key for plan in plans for key in _wanted_keys(plan))
    source = plans[0].file.source or mapping.source
    columns = read_wanted(path, source, keys, _list_roles(plans), skip_bad_rows=mapping.skip_bad_rows)
    return tuple(_build(plan, columns, mapping, path) for plan in plans)


def _convert_folder(folder: Path, mapping: Mapping) -> tuple[NamedRecording, ...]:
    """The recordings of all files in a folder that the mapping knows, or of all of its usual kind where it names none.

    Where the mapping has a file in a folder, it may lie there or beside the others.
    """
    if not mapping.files:
        inside = [one for one in sorted(folder.iterdir()) if one.is_file() and not one.name.startswith(".")]
        kinds = Counter(one.suffix.lower() for one in inside).most_common(1)
        logs = [one for one in inside if one.suffix.lower() == kinds[0][0]]
        return tuple(
            replace(named, name=_name_in(one.stem, named.name)) for one in logs for named in convert(one, mapping)
        )
    known = dict.fromkeys(rule.file for rule in mapping.files)
    logs = [one for one in (_find_inside(folder, name) for name in known) if one is not None]
    if not logs:
        raise RecordingError(f"{folder} has no file that the mapping knows: it has {', '.join(known)}")
    return tuple(named for one in logs for named in convert(one, mapping))


def _name_in(stem: str, name: str) -> str:
    """What a recording of one of several files is called."""
    return stem if name == _UNNAMED else f"{stem}/{name}"


def _with_date(facts: RecordingMetadata, time: Samples | None) -> RecordingMetadata:
    """The facts with when the first row was taken, where its stamp is a date and the mapping says none."""
    begin = float(time[0]) if time is not None and time.size else 0.0
    return facts if facts.recorded else replace(facts, recorded=format_date(begin))


def _find_inside(folder: Path, name: str) -> Path | None:
    """The file of this name, where the mapping has it or directly in the folder; None where there is none."""
    return next((one for one in (folder / name, folder / Path(name).name) if one.exists()), None)


def _list_known(mapping: Mapping) -> list[str]:
    """Names of the files that a mapping knows."""
    return [Path(rule.file).name for rule in mapping.files]


def _plan(mapping: Mapping, path: Path) -> list[_Plan]:
    rules = [rule for rule in mapping.files if Path(rule.file).name == path.name]
    if not mapping.files:
        rules = [FileRule(name="", file=path.name, rows=mapping.rows)]
    if not rules:
        known = ", ".join(rule.file for rule in mapping.files)
        raise RecordingError(f"the mapping knows no file {path.name!r}: it has {known}")
    return [plan for rule in rules for plan in _plan_file(mapping, rule)]


def _plan_file(mapping: Mapping, file: FileRule) -> list[_Plan]:
    joints = list(enumerate(mapping.joints)) or [(0, JointRule(name=""))]
    chosen = [(number, joint) for number, joint in joints if not file.joints or joint.name in file.joints]
    plans = []
    for number, joint in chosen:
        parts = [file.name] if len(chosen) == 1 and file.name else [file.name, joint.name]
        fields = {"joint": joint.name or "joint", **mapping.metadata, **joint.metadata, **file.metadata}
        levels = (mapping.metadata, joint.metadata, file.metadata)
        extras = [metadata_from_fields({"extra": level.get("extra", {})}).extra for level in levels]
        merged = {**fields, "extra": {name: value for extra in extras for name, value in extra.items()}}
        channels = {**mapping.channels, **joint.channels, **file.channels}
        name = "/".join(part for part in parts if part) or _UNNAMED
        plans.append(_Plan(name, joint, number, file, channels, metadata_from_fields(merged)))
    return plans


def _list_roles(plans: Sequence[_Plan]) -> dict[str, Column]:
    """The column of each channel, where one recording is made of all rows; else none."""
    if len(plans) != 1 or plans[0].file.where is not None or plans[0].file.rows is not None:
        return {}
    (plan,) = plans
    rules = {name: (rule.column, rule.joint_step) for name, rule in plan.channels.items()}
    return {name: plan.key(column, step) for name, (column, step) in rules.items() if column is not None}


def _wanted_keys(plan: _Plan) -> list[Column]:
    keys = [plan.key(rule.column, rule.joint_step) for rule in plan.channels.values() if rule.column is not None]
    keys += [plan.key(rule.times) for rule in plan.channels.values() if rule.times is not None]
    keys += [plan.key(rest) for rule in plan.channels.values() for rest, _ in _list_rests(rule)]
    return keys + ([plan.key(plan.file.where.column)] if plan.file.where else [])


def _build(plan: _Plan, columns: Columns, mapping: Mapping, path: Path) -> NamedRecording:
    rows = _select_rows(plan, columns, path)
    rows, findings = _leave_out_others(plan, columns, rows)
    if mapping.skip_bad_rows:
        keep, source = _find_usable(plan, columns, rows)
        rows, findings = rows[keep], (*findings, *tell_bad_rows(keep, source))
    channels = _fill_all(plan, columns, rows)
    facts = _with_date(plan.metadata, channels.get("time"))
    for name, rule in plan.channels.items():
        if rule.from_zero:
            channels[name] = channels[name] - channels[name][:1]
    for mend in (drop_twins, sort_rows, mend_stamps, order_runs) if _of_one_length(channels) else ():
        channels, told = mend(channels)
        findings += told
    try:
        recording = Recording.from_channels(channels, facts)
    except RecordingError as error:
        raise RecordingError(f"{path}, {plan.name}: {error}") from error
    if mapping.resample_rate is None:
        return NamedRecording(plan.name, recording, findings)
    recording, before = resample_checked(recording, mapping.resample_rate)
    return NamedRecording(plan.name, recording, findings + before)


def _of_one_length(channels: dict[str, Samples]) -> bool:
    """Whether every channel has one value a row; what has not is refused with its name."""
    return {values.shape for values in channels.values()} == {channels["time"].shape} and channels["time"].size > 2


def _leave_out_others(
    plan: _Plan, columns: Columns, rows: NDArray[np.intp]
) -> tuple[NDArray[np.intp], tuple[Finding, ...]]:
    """The rows that say anything of this joint, and a note on the messages of other devices on its topic."""
    time = plan.channels["time"]
    own = [key for key in _wanted_keys(plan) if time.column is None or key != plan.key(time.column, time.joint_step)]
    said = [np.isfinite(_take(find_column(columns, key), rows)) for key in own]
    keep = np.any(said, axis=0) if said else np.ones(rows.size, dtype=bool)
    others = int(np.count_nonzero(~keep))
    if not others or not keep.any():
        return rows, ()
    message = f"{others} of {rows.size} rows say nothing of this joint, as messages of other devices, and were left out"
    return rows[keep], (Finding("other_device", "note", message, "nothing to do"),)


def _find_usable(plan: _Plan, columns: Columns, rows: NDArray[np.intp]) -> tuple[NDArray[np.bool_], dict[str, Samples]]:
    """Which rows have a number in every column and a time that goes on, and what was asked. Shapes (n_rows,).

    Asked of the source, because one bad sample spoils all that follow it in a sum or an unwrapped angle.
    """
    source = {str(key): _take(find_column(columns, key), rows) for key in _wanted_keys(plan)}
    keep = np.all([np.isfinite(values) for values in source.values()], axis=0)
    time = np.full(rows.size, np.nan)
    time[keep] = _fill_all(plan, columns, rows[keep])["time"]
    keep[keep] = find_usable_rows({"time": time[keep]})
    return np.asarray(keep), {**source, "time": time}


def _fill_all(plan: _Plan, columns: Columns, rows: NDArray[np.intp]) -> dict[str, Samples]:
    channels: dict[str, Samples] = {}
    for name in _in_order(plan.channels):
        channels[name] = _fill(name, plan, columns, rows, channels)
    return channels


def _select_rows(plan: _Plan, columns: Columns, path: Path) -> NDArray[np.intp]:
    sizes = [find_column(columns, key).size for key in _wanted_keys(plan)]
    total = max(sizes, default=0)
    first, last = plan.file.rows or (1, total)
    if not 1 <= first < last <= total:
        raise RecordingError(f"{path}, {plan.name}: rows {first}..{last} are not among the {total} rows of the source")
    rows = np.arange(first - 1, last)
    where = plan.file.where
    return rows if where is None else rows[find_column(columns, plan.key(where.column))[rows] == where.equals]


def _in_order(channels: dict[str, ChannelRule]) -> list[str]:
    """Channels that others are made of come first."""
    order: list[str] = []

    def visit(name: str, above: tuple[str, ...]) -> None:
        if name in above or name not in channels:
            raise RecordingError(f"mapping: channel {name!r} is made of itself or is not defined")
        rule = channels[name]
        needs = ["time"] if rule.integral_of or (rule.delay and name != "time") else []
        for other in [*needs, *(part for part in (rule.integral_of, rule.plus) if part)]:
            visit(other, (*above, name))
        if name not in order:
            order.append(name)

    for name in CHANNELS:
        if name in channels:
            visit(name, ())
    return order


def _list_rests(rule: ChannelRule) -> list[tuple[Column, float]]:
    """Columns of the rest of a stamp of whole seconds, and what one of it is [s]."""
    rests = ((rule.nanoseconds, 1e-9), (rule.microseconds, 1e-6), (rule.milliseconds, 1e-3))
    return [(column, one) for column, one in rests if column is not None]


def _read_signs(rule: ChannelRule, values: Samples) -> Samples:
    """The numbers of a register with their signs, as the rule says that they are stored."""
    if rule.sign_bit is not None:
        values = np.where(values >= 2.0**rule.sign_bit, 2.0**rule.sign_bit - values, values)
    if rule.signed_bits is not None:
        values = np.where(values >= 2.0 ** (rule.signed_bits - 1), values - 2.0**rule.signed_bits, values)
    return values


def _fill(name: str, plan: _Plan, columns: Columns, rows: NDArray[np.intp], done: dict[str, Samples]) -> Samples:
    rule = plan.channels[name]
    values = _origin(rule, plan, columns, rows, done)
    values = _read_signs(rule, values)
    for rest, one in _list_rests(rule):
        values = values - values[:1] + one * _take(find_column(columns, plan.key(rest)), rows)
    if rule.times is not None:
        values = values * _take(find_column(columns, plan.key(rule.times)), rows)
    if rule.unit is not None:
        unit = find_unit(rule.unit)
        _require_unit(name, rule.unit, unit.si, plan.metadata)
        values = values * unit.factor + unit.offset
    values = values * (rule.sign * rule.scale) + rule.offset
    if rule.signed_range is not None:
        values = read_signed(values, rule.signed_range)
    if rule.unwrap is not None:
        values = np.unwrap(values, period=rule.unwrap)
    if rule.spread:
        values = spread_stamps(values)
    if rule.steps:
        values = np.cumsum(values)
    if rule.delay != 0.0 and name != "time":
        values = np.interp(done["time"] - rule.delay, done["time"], values)
    return values + done[rule.plus] if rule.plus is not None else values


def _origin(
    rule: ChannelRule, plan: _Plan, columns: Columns, rows: NDArray[np.intp], done: dict[str, Samples]
) -> Samples:
    if rule.column is not None:
        return _take(find_column(columns, plan.key(rule.column, rule.joint_step)), rows)
    if rule.rate is not None:
        return np.asarray((rows - rows[:1]) / rule.rate, dtype=np.float64)
    if rule.integral_of is not None:
        return integrate(done[rule.integral_of], done["time"])
    return np.full(rows.size, rule.constant, dtype=np.float64)


def _take(column: Samples, rows: NDArray[np.intp]) -> Samples:
    """Rows of a column; a single number of the source stands for every row."""
    if column.size == 1:
        return np.full(rows.size, column[0])
    if rows.size and rows[-1] >= column.size:
        raise RecordingError(f"a column of the source has {column.size} rows where another has {rows[-1] + 1}")
    return column if rows.size == column.size else column[rows]  # rows rise, so that as many are all of them


def _require_unit(channel: str, unit: str, si: str, metadata: RecordingMetadata) -> None:
    expected = _SI.get(channel)
    if channel == "normal_load":
        return
    wanted = metadata.torque_unit if expected is None else expected[metadata.motion == "linear"]
    if si != wanted:
        raise RecordingError(f"mapping: {channel} is in {wanted}, unit {unit!r} is a unit of {si}")
