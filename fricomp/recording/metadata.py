"""What a recording's numbers mean: joint, motion, units and which side of the gear the torque is on."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from math import isfinite
from typing import Any, Literal, get_args

import msgspec

from fricomp.errors import RecordingError

Motion = Literal["rotary", "linear"]
TorqueSide = Literal["joint", "motor"]
TorqueKind = Literal["measured", "estimated", "commanded"]

_SPELLINGS = {"Nm": "N·m", "N*m": "N·m", "N.m": "N·m", "N m": "N·m", "N⋅m": "N·m"}
_CHOICES = {"motion": get_args(Motion), "torque_side": get_args(TorqueSide), "torque_kind": get_args(TorqueKind)}
_POSITIVE = ("gear_ratio", "encoder_resolution", "velocity_limit", "clock_error")

_EARLIEST, _LATEST = 1e9, 3e9
"""Stamps since 1970 that are dates, from 2001 to 2065 [s]: smaller ones count since a start, larger ones since 1900."""


@dataclass(frozen=True)
class RecordingMetadata:
    """Facts about a recording that its columns cannot say.

    Attributes:
        joint: Name of the joint.
        motion: "rotary" (rad, rad/s) or "linear" (m, m/s).
        torque_unit: Unit of `torque`, `load_torque` and `torque_command`; empty means
            N·m for a rotary and N for a linear joint. "A" or "V" where only the drive's
            current or voltage is known.
        torque_side: Side of the gear that `torque` acts on. Positions are always joint side.
        torque_kind: Whether `torque` was measured, estimated or commanded.
        gear_ratio: Motor turns for one joint turn [1] (linear: [rad/m]).
        encoder_resolution: Step of `position` [rad | m].
        position_limits: Lowest and highest position of the joint [rad | m].
        velocity_limit: Largest speed of the joint [rad/s | m/s].
        continuous: The joint turns without end, so a long travel is nothing to wonder at.
        clock_error: Standard deviation of the stamps of the source from the instants of the samples [s].
        recorded: When the first sample was taken, as ISO 8601 has it; empty where the log does not tell.
        source: Where the samples come from.
        extra: Anything else worth keeping, as JSON values. Treat as read-only.

    Raises:
        RecordingError: A value is outside the list or the range above.
    """

    joint: str = "joint"
    motion: Motion = "rotary"
    torque_unit: str = ""
    torque_side: TorqueSide = "joint"
    torque_kind: TorqueKind = "measured"
    gear_ratio: float | None = None
    encoder_resolution: float | None = None
    position_limits: tuple[float, float] | None = None
    velocity_limit: float | None = None
    continuous: bool = False
    clock_error: float | None = None
    recorded: str = ""
    source: str = ""
    extra: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in _CHOICES:
            _require_choice(name, getattr(self, name))
        unit = self.torque_unit or ("N·m" if self.motion == "rotary" else "N")
        object.__setattr__(self, "torque_unit", _SPELLINGS.get(unit, unit))
        for name in _POSITIVE:
            value = getattr(self, name)
            if value is not None and not (isfinite(value) and value > 0):
                raise RecordingError(f"metadata {name} is {value}: give a positive number, or leave it out")
        limits = self.position_limits
        if limits is not None and not limits[0] < limits[1]:
            raise RecordingError(f"metadata position_limits is {limits}: the lower limit comes first")

    @property
    def position_unit(self) -> str:
        """Unit of `position`: "rad" or "m"."""
        return "rad" if self.motion == "rotary" else "m"


def list_dates(recordings: Iterable[RecordingMetadata]) -> dict[str, str]:
    """What a model says of when its recordings were taken: `recorded`, the earliest; nothing where none tells.

    Args:
        recordings: Facts of all.
    """
    known = sorted(one.recorded for one in recordings if one.recorded)
    return {"recorded": known[0]} if known else {}


def format_date(seconds: float) -> str:
    """A date and time of UTC as ISO 8601 has it; empty where it is of no year in which anything is logged.

    Args:
        seconds: Since 1970 [s].
    """
    if not _EARLIEST <= seconds < _LATEST:
        return ""
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds")


def shift_date(metadata: RecordingMetadata, later: float) -> RecordingMetadata:
    """The facts of rows that begin later: `recorded` is when the first of them was taken.

    Args:
        metadata: Of all rows.
        later: Time from the first of them to the first that is left [s].
    """
    if ":" not in metadata.recorded or later == 0.0:  # a day alone goes on
        return metadata
    try:
        date = datetime.fromisoformat(metadata.recorded)
    except ValueError:  # whoever wrote it by hand may have written anything
        return metadata
    return replace(metadata, recorded=(date + timedelta(seconds=later)).isoformat(timespec="milliseconds"))


def channel_units(metadata: RecordingMetadata) -> dict[str, str]:
    """Unit of every channel that a recording may have, by name."""
    x, torque = metadata.position_unit, metadata.torque_unit
    return {
        "time": "s",
        "position": x,
        "torque": torque,
        "velocity": f"{x}/s",
        "acceleration": f"{x}/s²",
        "load_torque": torque,
        "temperature": "°C",
        "current": "A",
        "position_reference": x,
        "velocity_reference": f"{x}/s",
        "torque_command": torque,
        "normal_load": "N",
        "motor_position": x,
        "housing_temperature": "°C",
        "supply_voltage": "V",
    }


def metadata_to_fields(metadata: RecordingMetadata) -> dict[str, Any]:
    """Return the fields that differ from their defaults, as JSON values, in declaration order."""
    blank = RecordingMetadata(motion=metadata.motion)
    names = RecordingMetadata.__dataclass_fields__
    always = ("joint", "motion", "torque_unit", "torque_side", "torque_kind")
    return {n: getattr(metadata, n) for n in names if n in always or getattr(metadata, n) != getattr(blank, n)}


def metadata_from_fields(fields: dict[str, Any]) -> RecordingMetadata:
    """Build metadata from JSON values; names that are no field of it are kept in `extra`.

    Raises:
        RecordingError: A field has the wrong type or value.
    """
    known = {name: value for name, value in fields.items() if name in RecordingMetadata.__dataclass_fields__}
    foreign = {name: value for name, value in fields.items() if name not in known}
    for name in _CHOICES:
        _require_choice(name, known.get(name, _CHOICES[name][0]))
    if not isinstance(known.get("extra", {}), dict):
        raise RecordingError(f"metadata extra is {known['extra']!r}: give an object of names and values")
    known["extra"] = {**known.get("extra", {}), **foreign}
    try:
        return msgspec.convert(known, RecordingMetadata)
    except msgspec.ValidationError as error:
        raise RecordingError(f"metadata of the recording: {error}") from error


def _require_choice(name: str, value: object) -> None:
    if value not in _CHOICES[name]:
        raise RecordingError(f"metadata {name} is {value!r}: valid are {', '.join(_CHOICES[name])}")
