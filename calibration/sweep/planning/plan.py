"""The plan of a sweep: which plateau, in which order, from where to where, for how long."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import NamedTuple

import numpy as np

from fricomp.errors import ParameterError
from fricomp.joint import JointCapabilities
from fricomp.laws import FloatArray

from .profile import Trapezoid, move_profile
from .settings import SweepSettings
from .settling import longest_settling
from .speed import log_spaced, parse_speeds

__all__ = [
    "Plateau",
    "SweepPlan",
    "Travel",
    "default_speeds",
    "first_again",
    "move_speed",
    "plan_plateaus",
    "plan_velocities",
    "top_speed",
    "travel_of",
]

# Of the joint's range, at each end, never entered [1].
MARGIN = 0.03
# Range that is used of a joint that turns freely [rad] or [m].
FREE_RANGE = 2.0 * np.pi
# A plateau must last until the encoder has counted this often, for a mean speed within a percent.
COUNTS = 100
LONGEST_DWELL = 20.0
# Shortest dwell at the highest speeds, where travel is short [s].
SHORTEST_DWELL = 0.4
# Decades from the highest speed down to the lowest where none is given.
SPEED_RATIO = 1000.0


@dataclass(frozen=True)
class Travel:
    """Where a joint may move in a sweep.

    Attributes:
        low: [rad] or [m].
        high: [rad] or [m].
        speed_limit: [rad/s] or [m/s].
        quantum: Step of its encoder [rad] or [m].
        speed_quantum: Step of the speeds it can be told [rad/s] or [m/s]; 0 where any can.
    """

    low: float
    high: float
    speed_limit: float
    quantum: float = 0.0
    speed_quantum: float = 0.0

    @property
    def length(self) -> float:
        """[rad] or [m]."""
        return self.high - self.low

    @property
    def middle(self) -> float:
        """[rad] or [m]."""
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Plateau:
    """One visit to one speed in one direction.

    Attributes:
        number: Its place in the run, from 0.
        velocity: Signed [rad/s] or [m/s].
        start: Position from which the motion starts, at rest [rad] or [m].
        ramp: Time to reach the speed [s].
        settle: Longest time until it has settled [s].
        dwell: Time on it after that [s].
        is_return: Whether it goes back over the way of the plateau before, from where that has ended.
        is_first_again: Whether it only repeats the first speed, to see drift.
    """

    number: int
    velocity: float
    start: float
    ramp: float
    settle: float
    dwell: float
    is_return: bool = False
    is_first_again: bool = False

    @property
    def profile(self) -> Trapezoid:
        """The motion, with all the time for settling."""
        return Trapezoid(self.velocity, self.ramp, self.settle + self.dwell)

    @property
    def stop(self) -> float:
        """Position at the end of the motion [rad] or [m]."""
        return self.start + self.profile.distance


@dataclass(frozen=True)
class SweepPlan:
    """All plateaus in order.

    Attributes:
        plateaus: In order of execution.
        travel: Within which they lie.
    """

    plateaus: tuple[Plateau, ...]
    travel: Travel

    @property
    def speeds(self) -> FloatArray:
        """Distinct speeds, rising [rad/s] or [m/s]. Shape (n_speeds,)."""
        return np.unique([abs(plateau.velocity) for plateau in self.plateaus])

    @property
    def reach(self) -> tuple[float, float]:
        """Lowest and highest position [rad] or [m]."""
        ends = [edge for plateau in self.plateaus for edge in (plateau.start, plateau.stop)]
        return min(ends), max(ends)

    @property
    def duration(self) -> float:
        """Time for all plateaus and the ways between them, at most [s]."""
        return sum(duration_with_way(plateau, self.travel) for plateau in self.plateaus)


def travel_of(joint: JointCapabilities, limits: tuple[float, float] | None, speed_limit: float, at: float) -> Travel:
    """Travel of a joint inside its limits, less a margin; a free joint turns once around where it is.

    Args:
        joint: As the drive declares it.
        limits: Of the safety gate [rad] or [m]; None for those of the drive.
        speed_limit: Of the safety gate [rad/s] or [m/s].
        at: Present position [rad] or [m].
    """
    low, high = limits or joint.position_limits or (at - 0.5 * FREE_RANGE, at + 0.5 * FREE_RANGE)
    margin = MARGIN * (high - low)
    speed = 0.8 * min(speed_limit, joint.velocity_limit)
    return Travel(low + margin, high - margin, speed, joint.position_quantum, joint.velocity_command_quantum)


def top_speed(travel: Travel, settings: SweepSettings) -> float:
    """The highest speed at which a plateau fits into the travel [rad/s] or [m/s]."""
    return min(travel.speed_limit, travel.length / (settings.ramp + settings.settle / 3.0 + SHORTEST_DWELL))


def possible_speeds(speeds: Sequence[float] | FloatArray, travel: Travel, settings: SweepSettings) -> FloatArray:
    """The nearest speeds that the drive can be told [rad/s] or [m/s]. Shape (n,)."""
    wanted, step = np.asarray(speeds, dtype=np.float64), travel.speed_quantum
    if step <= 0.0:
        return wanted
    most = np.floor(top_speed(travel, settings) / step)
    return np.asarray(np.clip(np.round(wanted / step), 1.0, max(most, 1.0)) * step)


def default_speeds(travel: Travel, settings: SweepSettings) -> FloatArray:
    """The speeds of the first pass, rising [rad/s] or [m/s]. Shape (n_speeds,)."""
    if settings.speeds:
        return parse_speeds(settings.speeds)
    top = top_speed(travel, settings)
    return log_spaced(top / SPEED_RATIO, top, settings.speed_count)


def plan_plateaus(
    speeds: Sequence[float] | FloatArray, travel: Travel, settings: SweepSettings, *, first: int = 0
) -> SweepPlan:
    """Plateaus over `speeds` in shuffled order, out and back over the same window each.

    Args:
        speeds: Positive [rad/s] or [m/s].
        travel: Where the joint may move.
        settings: Repeats, dwell, order.
        first: Number of the first plateau; a later pass goes on where an earlier one ended.

    Raises:
        ParameterError: A speed is too high for the travel.
    """
    generator = np.random.default_rng([settings.seed, first])
    wanted = np.asarray(speeds) if travel.speed_quantum <= 0.0 else np.unique(possible_speeds(speeds, travel, settings))
    visits = [float(speed) for _ in range(settings.repeats) for speed in generator.permutation(wanted)]
    plateaus: list[Plateau] = []
    for visit, speed in enumerate(visits):
        shape = _shape(speed, travel, settings, place=visit % settings.positions)
        sign = int(generator.choice([-1, 1]))
        out = _centre(shape, sign * speed, first + len(plateaus))
        plateaus += [out, replace(_centre(shape, -sign * speed, out.number + 1), is_return=True)]
    return SweepPlan(tuple(plateaus), travel)


def first_again(plan: SweepPlan, number: int) -> SweepPlan:
    """The first two plateaus of a plan once more, to see drift; `number` is that of the first of them."""
    repeated = (replace(p, number=number + i, is_first_again=True) for i, p in enumerate(plan.plateaus[:2]))
    return SweepPlan(tuple(repeated), plan.travel)


def plan_velocities(
    velocities: Sequence[float] | FloatArray, travel: Travel, settings: SweepSettings, *, first: int
) -> SweepPlan:
    """Plateaus at signed velocities [rad/s] or [m/s], in alternating directions as far as they go.

    Raises:
        ParameterError: A speed is too high for the travel.
    """
    generator = np.random.default_rng([settings.seed, first])
    signed = np.asarray(velocities, dtype=np.float64)
    wanted = generator.permutation(np.sign(signed) * possible_speeds(np.abs(signed), travel, settings))
    forward, reverse = wanted[wanted > 0.0].tolist(), wanted[wanted < 0.0].tolist()
    mixed = [v for pair in zip_longest(forward, reverse) for v in pair if v is not None]
    shapes = [_shape(abs(v), travel, settings) for v in mixed]
    return SweepPlan(
        tuple(_centre(s, v, first + i) for i, (s, v) in enumerate(zip(shapes, mixed, strict=True))), travel
    )


class _Shape(NamedTuple):
    centre: float
    ramp: float
    settle: float
    dwell: float


def _shape(speed: float, travel: Travel, settings: SweepSettings, place: int = 0) -> _Shape:
    """How long a plateau lasts, and about where."""
    if speed > top_speed(travel, settings) * (1.0 + 1e-9):
        raise ParameterError(
            f"a plateau at {speed:g} does not fit into a travel of {travel.length:.3g}: "
            f"the highest speed is {top_speed(travel, settings):.3g}"
        )
    dwell = min(max(settings.dwell, COUNTS * travel.quantum / speed), LONGEST_DWELL)
    room = travel.length / speed - settings.ramp
    settle = min(max(settings.settle, longest_settling(speed, travel.quantum)), room / 3.0)
    dwell = min(dwell, room - settle)
    half = 0.5 * speed * (settings.ramp + settle + dwell)
    centre = travel.low + (place + 0.5) / settings.positions * travel.length
    centre = min(max(centre, travel.low + half), travel.high - half)
    return _Shape(centre, settings.ramp, settle, dwell)


def _centre(shape: _Shape, velocity: float, number: int) -> Plateau:
    start = shape.centre - 0.5 * velocity * (shape.ramp + shape.settle + shape.dwell)
    return Plateau(number, velocity, start, shape.ramp, shape.settle, shape.dwell)


def duration_with_way(plateau: Plateau, travel: Travel) -> float:
    """Time of a plateau and of getting to its start, estimated [s]."""
    way = move_profile(plateau.start - travel.middle, move_speed(travel), plateau.ramp)
    return plateau.profile.duration + 0.5 * way.duration


def move_speed(travel: Travel) -> float:
    """Speed of getting from place to place [rad/s] or [m/s]."""
    return min(0.5 * travel.speed_limit, 0.5 * travel.length)
