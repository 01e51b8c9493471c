"""Friction points: one a plateau, from its settled part, less the rigid-body torque."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .steadiness import Verdict, find_transient, judge_plateau, mean_of


@dataclass(frozen=True)
class SettledPart:
    """The settled part of one plateau.

    Attributes:
        number: Of the plateau.
        velocity: Asked for, signed [rad/s] or [m/s].
        samples: From settling to the end of the plateau.
        settled: Whether settling was seen.
        is_first_again: Whether it only repeats the first speed.
    """

    number: int
    velocity: float
    samples: Recording
    settled: bool = True
    is_first_again: bool = False


@dataclass(frozen=True)
class FrictionPoint:
    """What one plateau says.

    Attributes:
        number: Of the plateau.
        time: In the middle of it [s].
        velocity: Mean, from the distance travelled [rad/s] or [m/s].
        torque: Mean friction torque, with the sign of the velocity [N·m] or [N].
        deviation: Standard error of `torque` from the scatter inside the plateau [N·m] or [N].
        load_rate: Mean rate of the rigid-body torque [N·m/s] or [N/s].
        ripple: Standard deviation of the torque within the plateau, noise included [N·m] or [N].
        duration: Of the settled part [s].
        verdict: `steady`, or why it is not used.
        load_torque: Mean rigid-body torque [N·m] or [N].
        normal_load: Mean normal load; None where none is known.
        temperature: Mean [°C]; None where it is not reported.
        is_first_again: Whether it only repeats the first speed.
    """

    number: int
    time: float
    velocity: float
    torque: float
    deviation: float
    duration: float
    verdict: Verdict
    load_torque: float = 0.0
    normal_load: float | None = None
    temperature: float | None = None
    is_first_again: bool = False
    ripple: float = 0.0
    load_rate: float = 0.0


def measure_points(
    parts: Sequence[SettledPart], *, offset: float, lag: float, quantum: float, torque_limit: float
) -> tuple[FrictionPoint, ...]:
    """One friction point a plateau.

    Args:
        parts: Settled parts.
        offset: Zero of the torque sensor [N·m] or [N].
        lag: Age of the torque signal beside the position [s].
        quantum: Step of the encoder [rad] or [m].
        torque_limit: Of the drive [N·m] or [N].
    """
    return tuple(_measure(part, offset, lag, quantum, torque_limit) for part in parts)


def _measure(part: SettledPart, offset: float, lag: float, quantum: float, torque_limit: float) -> FrictionPoint:
    samples = part.samples
    load = samples.load_torque
    friction, rate = samples.torque - offset, np.zeros(len(samples))
    if load is not None:
        rate = np.gradient(load, samples.time)
        friction = friction - load + lag * rate
    verdict: Verdict = judge_plateau(
        samples.time, samples.position, samples.torque, part.velocity, quantum=quantum, torque_limit=torque_limit
    )
    if verdict == "steady" and not part.settled:
        verdict = "unsettled"
    mean = mean_of(friction)
    return FrictionPoint(
        number=part.number,
        time=float(samples.time.mean()),
        velocity=_fit_mean_velocity(samples.time, samples.position),
        torque=mean.value,
        deviation=mean.deviation,
        duration=samples.duration,
        verdict=verdict,
        load_torque=0.0 if load is None else float(load.mean()),
        normal_load=None if samples.normal_load is None else float(samples.normal_load.mean()),
        temperature=None if samples.temperature is None else float(samples.temperature.mean()),
        is_first_again=part.is_first_again,
        ripple=float(np.std(friction)),
        load_rate=float(rate.mean()),
    )


def _fit_mean_velocity(time: FloatArray, position: FloatArray) -> float:
    """Slope of the straight line through the positions [rad/s] or [m/s]."""
    centred = time - time.mean()
    return float(centred @ position / (centred @ centred))


def without_transient(part: SettledPart) -> SettledPart:
    """A settled part without what its torque still shows of the way there."""
    samples = part.samples
    load = 0.0 if samples.load_torque is None else samples.load_torque
    return replace(part, samples=samples.rows(slice(find_transient(samples.torque - load), None)))


def match_windows(parts: Sequence[SettledPart]) -> tuple[SettledPart, ...]:
    """Forward and reverse plateaus of a pair cut to the positions that both have passed settled.

    Only over the same positions is gravity, or whatever else depends on position, the same in both.
    """
    by_number = {part.number: part for part in parts}
    found = []
    for part in parts:
        partner = by_number.get(part.number ^ 1)
        if partner is None:
            continue
        low = max(p.samples.position.min() for p in (part, partner))
        high = min(p.samples.position.max() for p in (part, partner))
        inside = (part.samples.position >= low) & (part.samples.position <= high)
        if inside.sum() >= 2:
            found.append(replace(part, samples=part.samples.rows(inside)))
    return tuple(found)


def half_differences(points: Sequence[FrictionPoint]) -> tuple[FrictionPoint, ...]:
    """Points with what is the same in both directions taken off: gravity where no model says what it is.

    Forward and reverse plateaus over the same window come in pairs (numbers 2k and 2k+1). Half their difference is
    the mean friction of both directions; a difference between the directions cannot be told from gravity.
    """
    found: list[FrictionPoint] = []
    by_number = {point.number: point for point in points}
    for number in sorted(n for n in by_number if n % 2 == 0):
        a, b = by_number[number], by_number.get(number + 1)
        if b is None:
            continue
        half = 0.5 * (abs(a.torque * np.sign(a.velocity) + b.torque * np.sign(b.velocity)))
        rate = 0.5 * (a.load_rate * np.sign(a.velocity) + b.load_rate * np.sign(b.velocity))
        deviation = 0.5 * float(np.hypot(a.deviation, b.deviation))
        verdict = a.verdict if a.verdict != "steady" else b.verdict
        for point in (a, b):
            sign, spread = float(np.sign(point.velocity)), deviation * float(np.sqrt(2.0))
            found.append(replace(point, torque=sign * half, deviation=spread, verdict=verdict, load_rate=sign * rate))
    return tuple(found)
