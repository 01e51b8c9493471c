"""From the blocks of a sweep to friction points, with everything that had to be taken off and checked on the way."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from fricomp.errors import IdentificationError, ParameterError
from fricomp.recording import Recording, RecordingMetadata

from .block import Kind, SweepData
from .breakaway import Breakaway, half_differences_at_rest, measure_breakaway
from .gravity_fit import GravityFit, fit_gravity
from .point import FrictionPoint, SettledPart, half_differences, match_windows, measure_points, without_transient
from .rigid_body_fit import RigidBodyFit, fit_rigid_body
from .steadiness import Mean, mean_of

__all__ = ["HALF_DIFFERENCE", "Drift", "SweepAnalysis", "TorqueSource", "analyse_sweep", "measure_offset", "parse_load"]

HALF_DIFFERENCE: Final = "half difference of both directions"
TorqueSource = Literal[
    "measured torque", "measured torque less the rigid-body torque", "half difference of both directions"
]
"""How friction was made out of the measured torque."""
FAST_KINDS: tuple[Kind, ...] = ("warm_up", "plateau")


@dataclass(frozen=True)
class Drift:
    """The first speed visited again at the end.

    Attributes:
        velocity: Signed [rad/s] or [m/s].
        change: Friction at the end less friction at the start, in the direction of motion [N·m] or [N].
        deviation: Standard error of `change` [N·m] or [N].
        elapsed: Time between the two [s].
    """

    velocity: float
    change: float
    deviation: float
    elapsed: float


@dataclass(frozen=True)
class SweepAnalysis:
    """What a sweep has measured.

    Attributes:
        points: One a plateau, used or not, in order of time.
        breakaways: Static torques.
        offset: Zero of the torque sensor [N·m] or [N].
        rigid_body: What fast motions say about the torque signal and the model.
        torque_source: How friction was made out of torque.
        load_source: Where the normal load comes from, in words.
        drift: Of each direction.
        assistance: Torque that the drive itself adds in the direction of motion [N·m] or [N]; None where it cannot
            be seen because the drive closes the loop.
        metadata: Of the recording.
        sample_rate: Of the plateaus [Hz].
        gravity: As the mean of both directions shows it; None where a model says what it is, or nothing does.
    """

    points: tuple[FrictionPoint, ...]
    breakaways: tuple[Breakaway, ...]
    offset: Mean
    rigid_body: RigidBodyFit
    torque_source: TorqueSource
    load_source: str
    drift: tuple[Drift, ...]
    assistance: Mean | None
    metadata: RecordingMetadata
    sample_rate: float = 500.0
    gravity: GravityFit | None = None

    @property
    def steady(self) -> tuple[FrictionPoint, ...]:
        """The points that are used."""
        return tuple(point for point in self.points if point.verdict == "steady")

    @property
    def rejected(self) -> tuple[FrictionPoint, ...]:
        """The points that are not."""
        return tuple(point for point in self.points if point.verdict != "steady")

    @property
    def mean_load(self) -> float | None:
        """Mean normal load of the points that are used; None where it is not known."""
        loads = [point.normal_load for point in self.steady if point.normal_load is not None]
        return float(np.mean(loads)) if loads else None

    def static_torque(self, direction: int) -> Mean | None:
        """Breakaway torque of one direction: mean over the positions, and its standard error; None if unmeasured."""
        values = np.array([b.torque for b in self.breakaways if b.direction == direction])
        if not len(values):
            return None
        spread = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
        return Mean(float(values.mean()), spread / float(np.sqrt(len(values))))


def analyse_sweep(data: SweepData, *, normal_load: str = "none", gravity_unknown: bool = False) -> SweepAnalysis:
    """Friction points of a sweep.

    Args:
        data: Its blocks.
        normal_load: `none`, `transmitted` (the size of the rigid-body torque), `column` (as recorded), or a number.
        gravity_unknown: Take the half difference of both directions, because no model says what gravity is.

    Raises:
        IdentificationError: There is no plateau.
        ParameterError: The normal load is none of these, or not to be had.
    """
    parts, gravity = _select_comparable_parts(data, gravity_unknown)
    modelled = gravity is None and parts[0].samples.load_torque is not None
    metadata = parts[0].samples.metadata
    quantum = metadata.encoder_resolution or 0.0
    offset = measure_offset(data)
    fit = fit_rigid_body(samples for kind in FAST_KINDS for _, samples in data.of_kind(kind))
    points = measure_points(
        parts,
        offset=offset.value,
        lag=fit.lag if gravity is None else gravity.lag,
        quantum=quantum,
        torque_limit=float(metadata.extra.get("torque_limit", np.inf)),
    )
    breakaways = _find_breakaways(data, offset.value, quantum)
    loaded, load_source = _with_normal_load(points, normal_load)
    compared = half_differences(loaded) if gravity_unknown else loaded
    return SweepAnalysis(
        points=compared,
        breakaways=half_differences_at_rest(breakaways) if gravity_unknown else breakaways,
        offset=offset,
        rigid_body=fit,
        torque_source=_choose_torque_source(gravity_unknown, modelled),
        load_source=load_source,
        drift=_measure_drift(compared),
        assistance=_measure_assistance([part.samples for part in parts], [p.velocity for p in points]),
        metadata=metadata,
        sample_rate=1.0 / float(np.median([part.samples.sample_period for part in parts])),
        gravity=gravity,
    )


def _select_comparable_parts(
    data: SweepData, gravity_unknown: bool
) -> tuple[tuple[SettledPart, ...], GravityFit | None]:
    """The parts of the plateaus that count, and gravity where the recording itself has to show it."""
    parts = data.settled_parts()
    if not parts:
        raise IdentificationError("the recording holds no plateau: run the sweep first, or resume it")
    if not gravity_unknown:
        return tuple(map(without_transient, parts)), None
    parts = match_windows(parts)
    if not parts:
        raise IdentificationError(
            "no forward and reverse plateau have settled over the same positions: stay longer on each (--dwell)"
        )
    gravity = fit_gravity(parts) if parts[0].samples.load_torque is None else None
    return parts if gravity is None else tuple(map(gravity.attach, parts)), gravity


def _find_breakaways(data: SweepData, offset: float, quantum: float) -> tuple[Breakaway, ...]:
    """What every ramp has shown."""
    measured = [
        (ramp, measure_breakaway(r, ramp.direction, offset=offset, quantum=quantum)) for ramp, r in data.ramps()
    ]
    return tuple(replace(found, number=ramp.number) for ramp, found in measured if found is not None)


def _choose_torque_source(gravity_unknown: bool, modelled: bool) -> TorqueSource:
    if gravity_unknown:
        return HALF_DIFFERENCE
    return "measured torque less the rigid-body torque" if modelled else "measured torque"


def measure_offset(data: SweepData) -> Mean:
    """Zero of the torque sensor, from all rests; zero and unknown where there is none."""
    rests = [_average_rest(samples) for _, samples in data.of_kind("tare")]
    if not rests:
        return Mean(0.0, 0.0)
    values, deviations = np.array([r.value for r in rests]), np.array([r.deviation for r in rests])
    # A zero that has moved between the rests is known no better than half of that.
    own = float(np.hypot(np.sqrt(np.sum(deviations**2)) / len(rests), _compute_rounding(data)))
    moved = 0.5 * float(np.ptp(values))
    return Mean(float(values.mean()), max(own, moved if moved > 3.0 * own else 0.0))


def _average_rest(samples: Recording) -> Mean:
    """Zero from one rest. A reading that never changes is known to its step only: the zero is where it is nearest to
    none, because a code for exactly no torque is one that some drives do not have."""
    mean = mean_of(samples.torque)
    if np.ptp(samples.torque) > 0.0:
        return mean
    half = 0.5 * _find_torque_quantum(samples)
    return Mean(float(np.sign(mean.value)) * max(abs(mean.value) - half, 0.0), 0.0)


def _find_torque_quantum(samples: Recording) -> float:
    return float(samples.metadata.extra.get("torque_quantum", 0.0))


def _compute_rounding(data: SweepData) -> float:
    """Standard deviation of the zero that rounding leaves [N·m] or [N]: q / sqrt(12) times exp(-2 pi^2 s^2 / q^2)
    with a noise s before the step q, which dithers it [widrow2008]."""
    left = [0.0]
    for _, samples in data.of_kind("tare"):
        step = _find_torque_quantum(samples)
        if step > 0.0:
            noise = max(float(np.var(samples.torque)) / step**2 - 1.0 / 12.0, 0.0)
            left.append(step / np.sqrt(12.0) * np.exp(-2.0 * np.pi**2 * noise))
    return float(max(left))


def _with_normal_load(points: Sequence[FrictionPoint], choice: str) -> tuple[tuple[FrictionPoint, ...], str]:
    if choice == "none":
        return tuple(replace(p, normal_load=None) for p in points), "unknown, taken as constant"
    if choice == "transmitted":
        return tuple(replace(p, normal_load=abs(p.load_torque)) for p in points), "the model's transmitted torque"
    if choice == "column":
        if any(p.normal_load is None for p in points):
            raise ParameterError("the recording has no normal_load column: use transmitted, none or a number")
        return tuple(points), "a sensor column"
    value = parse_load(choice)
    return tuple(replace(p, normal_load=value) for p in points), f"given as {value:g}"


def parse_load(choice: str) -> float:
    """A normal load given as a number.

    Raises:
        ParameterError: It is no positive number.
    """
    try:
        value = float(choice)
    except ValueError:
        raise ParameterError(f"normal load {choice!r} is none of none, transmitted or a number") from None
    if not (value > 0.0 and np.isfinite(value)):
        raise ParameterError(f"a normal load must be positive and finite, got {choice!r}")
    return value


def _measure_drift(points: Sequence[FrictionPoint]) -> tuple[Drift, ...]:
    found = []
    for again in (p for p in points if p.is_first_again):
        first = next(
            (p for p in points if not p.is_first_again and np.isclose(p.velocity, again.velocity, rtol=0.05)), None
        )
        if first is not None:
            change = float(np.sign(again.velocity)) * (again.torque - first.torque)
            error = float(np.hypot(again.deviation, first.deviation))
            found.append(Drift(again.velocity, change, error, again.time - first.time))
    return tuple(found)


def _measure_assistance(samples: Sequence[Recording], velocities: Sequence[float]) -> Mean | None:
    """Reported less commanded torque in the direction of motion: what a drive adds that nobody asked for."""
    excess: dict[int, list[float]] = {1: [], -1: []}
    for recording, velocity in zip(samples, velocities, strict=True):
        if recording.torque_command is None:
            return None
        direction = 1 if velocity > 0.0 else -1
        excess[direction].append(float(np.mean(recording.torque - recording.torque_command)))
    if not (excess[1] and excess[-1]):
        return None
    forward, reverse = np.array(excess[1]), np.array(excess[-1])
    error = 0.5 * float(np.hypot(np.std(forward) / np.sqrt(len(forward)), np.std(reverse) / np.sqrt(len(reverse))))
    return Mean(0.5 * float(forward.mean() - reverse.mean()), error)
