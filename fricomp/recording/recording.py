"""One joint's time series: the value that everything else in the library reads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from typing import TYPE_CHECKING, Any, Self

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricomp.errors import RecordingError
from fricomp.overview import Overview, OverviewTable, Shown
from fricomp.recording.finding import raise_errors
from fricomp.recording.metadata import RecordingMetadata, channel_units, metadata_to_fields, shift_date
from fricomp.recording.validity import Samples, find_invalid

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

REQUIRED_CHANNELS = ("time", "position", "torque")
OPTIONAL_CHANNELS = (
    "velocity",
    "acceleration",
    "load_torque",
    "temperature",
    "current",
    "position_reference",
    "velocity_reference",
    "torque_command",
    "normal_load",
    "motor_position",
    "housing_temperature",
    "supply_voltage",
)
CHANNELS = REQUIRED_CHANNELS + OPTIONAL_CHANNELS
_TORQUES = ("torque", "load_torque", "torque_command")


@dataclass(frozen=True, eq=False, repr=False)
class Recording(Shown):
    """One joint's samples over time, SI units, joint side; +torque accelerates +position.

    Every array has shape (n_samples,), is float64, finite and read-only; time rises from row
    to row. Anything array-like is accepted and copied once.

    Attributes:
        time: [s]
        position: [rad | m]
        torque: [N·m | N], or the unit that `metadata.torque_unit` states.
        velocity: [rad/s | m/s]
        acceleration: [rad/s² | m/s²]
        load_torque: Torque that the joint transmits to its load [as torque].
        temperature: [°C]
        current: [A]
        position_reference: [rad | m]
        velocity_reference: [rad/s | m/s]
        torque_command: [as torque]
        normal_load: Load that presses the friction surfaces together [N, or as the metadata say].
        motor_position: Of the motor's own encoder, brought to the joint side of the gear [rad | m].
        housing_temperature: Beside `temperature`, which is then the winding's [°C].
        supply_voltage: [V]
        metadata: Joint, units, side of the torque.

    Raises:
        RecordingError: A channel has another length, a sample that is not finite, or time
            does not rise; the message names row, column and what to do.
    """

    time: Samples
    position: Samples
    torque: Samples
    velocity: Samples | None = None
    acceleration: Samples | None = None
    load_torque: Samples | None = None
    temperature: Samples | None = None
    current: Samples | None = None
    position_reference: Samples | None = None
    velocity_reference: Samples | None = None
    torque_command: Samples | None = None
    normal_load: Samples | None = None
    motor_position: Samples | None = None
    housing_temperature: Samples | None = None
    supply_voltage: Samples | None = None
    metadata: RecordingMetadata = field(default_factory=RecordingMetadata)

    def __post_init__(self) -> None:
        for name in CHANNELS:
            values = getattr(self, name)
            if values is not None:
                object.__setattr__(self, name, _read_only(name, values))
        raise_errors(find_invalid(self.channels), f"recording of joint {self.metadata.joint!r}")

    def __setstate__(self, state: dict[str, object]) -> None:
        """Restore a pickled recording; numpy forgets there that its arrays are read-only."""
        self.__dict__.update(state)
        for values in self.channels.values():
            values.flags.writeable = False

    @classmethod
    def from_channels(cls, channels: Mapping[str, ArrayLike], metadata: RecordingMetadata | None = None) -> Self:
        """Build a recording from a table of channels.

        Raises:
            RecordingError: A name is no channel, a required one is missing, or see the class.
        """
        _require_known(channels)
        missing = [name for name in REQUIRED_CHANNELS if name not in channels]
        if missing:
            raise RecordingError(f"channel {missing[0]!r} is missing: {', '.join(REQUIRED_CHANNELS)} are required")
        arrays = {name: _read_only(name, values) for name, values in channels.items()}
        return cls(**arrays, metadata=metadata or RecordingMetadata())

    def __len__(self) -> int:
        """Number of samples."""
        return int(self.time.size)

    @property
    def channels(self) -> dict[str, Samples]:
        """The channels that are present, by name, in the order of `CHANNELS`."""
        return {name: values for name in CHANNELS if (values := getattr(self, name)) is not None}

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def sample_period(self) -> float:
        """Median time between samples [s]."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def content_hash(self) -> str:
        """SHA-256 over channel names, little-endian samples and metadata, as hexadecimal digits."""
        digest = sha256(b"fricomp.recording/1")
        digest.update(msgspec.json.encode(metadata_to_fields(self.metadata), order="deterministic"))
        for name, values in self.channels.items():
            digest.update(f"\n{name} {values.size}\n".encode())
            digest.update(values.astype("<f8").tobytes())
        return digest.hexdigest()

    def headline(self) -> str:
        """Joint, duration, rate and channels."""
        rate = f", {1.0 / self.sample_period:.4g} Hz" if len(self) > 1 else ""
        names = ", ".join(name for name in self.channels if name != "time")
        return f"of joint {self.metadata.joint}: {self.duration:.4g} s{rate}, {names} [{self.metadata.torque_unit}]"

    def overview(self) -> Overview:
        """Every channel with its unit and range, and the metadata."""
        units = channel_units(self.metadata)
        rows = tuple(
            (name, units[name], f"{values.min():.4g}", f"{values.max():.4g}", f"{values.std():.4g}")
            for name, values in self.channels.items()
        )
        facts = metadata_to_fields(self.metadata)
        rate = f" at {1.0 / self.sample_period:.4g} Hz" if len(self) > 1 else ""
        return Overview(
            f"Recording of joint {self.metadata.joint}: {len(self)} samples, {self.duration:.4g} s{rate}",
            tuple(f"{name.replace('_', ' ')}: {value}" for name, value in facts.items() if name != "joint"),
            (OverviewTable(("channel", "unit", "lowest", "highest", "standard deviation"), rows),),
        )

    def plot(self, *channels: str) -> Figure:
        """Draw channels over time, one below the other, with matplotlib.

        Args:
            channels: Names of those that are drawn; all if none is given.

        Raises:
            RecordingError: The recording has no such channel.
            MissingExtraError: matplotlib is not installed.
        """
        from fricomp.recording.chart import channel_chart
        from fricomp.report import draw_figure

        absent = [name for name in channels if name not in self.channels]
        if absent:
            raise RecordingError(f"the recording has no channel {absent[0]!r}: it has {', '.join(self.channels)}")
        shown = {name: self.channels[name] for name in channels or self.channels if name != "time"}
        return draw_figure(channel_chart(self.time, shown, channel_units(self.metadata), self.metadata.joint))

    def to_pandas(self) -> DataFrame:
        """Return a data frame with a column a channel and the time [s] as its index.

        `attrs` holds the unit of each column under `units` and the metadata under `metadata`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        from fricomp.recording.frame import write_frame

        return write_frame(self.channels, self.metadata)

    @classmethod
    def from_pandas(
        cls, frame: DataFrame, metadata: RecordingMetadata | None = None, *, columns: Mapping[str, str] | None = None
    ) -> Self:
        """Build a recording from a data frame in SI units.

        Args:
            frame: Columns named as channels; others are left out. Time [s] is a column, or the index where it is
                numbers, a `TimedeltaIndex` or a `DatetimeIndex`.
            metadata: Joint, units, side of the torque; those in `frame.attrs`, as `to_pandas` writes them, if None.
            columns: Channel to the name of its column, where they differ, such as `{"position": "q"}`.

        Raises:
            RecordingError: A channel is missing, states another unit in `attrs`, or see the class.
            MissingExtraError: pandas is not installed.
        """
        from fricomp.recording.frame import read_frame

        return cls.from_channels(*read_frame(frame, metadata, dict(columns or {})))

    def window(self, start: float, stop: float) -> Self:
        """Return the samples with start <= time < stop [s].

        Raises:
            RecordingError: Fewer than two samples lie in the window.
        """
        first, last = np.searchsorted(self.time, [start, stop])
        if last - first < 2:
            raise RecordingError(
                f"window {start:g}..{stop:g} s holds {last - first} samples: "
                f"the recording spans {self.time[0]:g}..{self.time[-1]:g} s"
            )
        return self.rows(slice(first, last))

    def rows(self, selection: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Self:
        """Return the selected samples: a slice, a mask of shape (n_samples,) or rising indices."""
        left = {name: values[selection] for name, values in self.channels.items()}
        first = float(left["time"][0]) if left["time"].size else float(self.time[0])
        return self.from_channels(left, shift_date(self.metadata, first - float(self.time[0])))

    def with_channels(self, **channels: ArrayLike | None) -> Self:
        """Return a copy with these channels replaced, added, or removed where None is given."""
        _require_known(channels)
        kept = {name: values for name, values in {**self.channels, **channels}.items() if values is not None}
        return self.from_channels(kept, self.metadata)

    def with_metadata(self, **fields: object) -> Self:
        """Return a copy with these metadata fields changed."""
        return replace(self, metadata=replace(self.metadata, **fields))  # type: ignore[arg-type]

    def on_joint_side(self) -> Self:
        """Return the recording with its torques brought through the gear to the joint.

        Currents and voltages have no side and stay as they are; losses of the gear stay in
        the friction.

        Raises:
            RecordingError: The torque is on the motor side and the gear ratio is unknown.
        """
        ratio, motor_side = self.metadata.gear_ratio, self.metadata.torque_side == "motor"
        if not motor_side:
            return self
        if ratio is None:
            raise RecordingError("torque is on the motor side and gear_ratio is unknown: state it in the metadata")
        if self.metadata.torque_unit not in ("N·m", "N"):
            return self.with_metadata(torque_side="joint")
        torques = {name: self.channels[name] * ratio for name in _TORQUES if name in self.channels}
        unit = "N·m" if self.metadata.motion == "rotary" else "N"
        return self.with_channels(**torques).with_metadata(torque_side="joint", torque_unit=unit)


def concatenate(recordings: Sequence[Recording], gap: float | None = None) -> Recording:
    """Join recordings of one joint one after the other, with the channels all of them have.

    Args:
        recordings: At least one, in order; the metadata of the first is kept.
        gap: Time between the last sample of one and the first of the next [s]; None keeps
            the time stamps, which then must rise across the joints.

    Raises:
        RecordingError: None given, units differ, or time does not rise.
    """
    if not recordings:
        raise RecordingError("no recording to concatenate: give at least one")
    first = recordings[0]
    for other in recordings[1:]:
        if (other.metadata.motion, other.metadata.torque_unit) != (first.metadata.motion, first.metadata.torque_unit):
            raise RecordingError(
                f"cannot join {first.metadata.motion} [{first.metadata.torque_unit}] with "
                f"{other.metadata.motion} [{other.metadata.torque_unit}]: convert them to one unit first"
            )
    shared = [name for name in CHANNELS if all(name in recording.channels for recording in recordings)]
    columns = {name: np.concatenate([r.channels[name] for r in recordings]) for name in shared if name != "time"}
    columns["time"] = _join_times([r.time for r in recordings], gap)
    return Recording.from_channels(columns, first.metadata)


def _join_times(times: Sequence[Samples], gap: float | None) -> Samples:
    if gap is None:
        return np.concatenate(times)
    joined = [times[0]]
    for time in times[1:]:
        joined.append(time - time[0] + joined[-1][-1] + gap)
    return np.concatenate(joined)


def _require_known(names: Iterable[str]) -> None:
    for name in names:
        if name not in CHANNELS:
            raise RecordingError(f"unknown channel {name!r}: valid are {', '.join(CHANNELS)}")


def _is_settled(array: NDArray[Any]) -> bool:
    return array.dtype == np.float64 and array.base is None and not array.flags.writeable


def _read_only(name: str, values: ArrayLike) -> Samples:
    """The values as an array that nobody changes; one that owns its values and is read-only already is no copy."""
    if isinstance(values, np.ndarray) and _is_settled(values):
        return values
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordingError(f"column {name} holds something that is no number: {error}") from error
    array.flags.writeable = False
    return array
