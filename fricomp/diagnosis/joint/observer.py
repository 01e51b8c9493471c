"""Observed simulation of a recording: what the model lacks, as a torque over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..inputs.delay import apply_lags, shift, undo_lags
from ..inputs.track import FloatArray, Track
from .kernel import FRICTION_SLOTS, LANES, observe
from .settings import JOINT
from .threads import run_in_threads

__all__ = [
    "Contribution",
    "Count",
    "Observation",
    "Observer",
    "Plant",
    "broadcast_level",
    "choose_lanes",
    "compute_missing_torques",
    "compute_torque",
    "count_joints",
    "simulate_all",
    "stack_plants",
]


@dataclass(frozen=True)
class Plant:
    """The joint that the observer simulates.

    Attributes:
        inertia: J [kg·m²] or [kg].
        gravity: Coefficients of cos q and sin q [N·m].
        offset: Constant torque [N·m].
        forward: F_c, F_s [N·m], v_s [rad/s], F_v [N·m·s/rad] for v > 0.
        reverse: The same numbers for v < 0.
        sigma_0: Bristle stiffness [N·m/rad].
        sigma_1: Bristle damping [N·m·s/rad].
        lag: Time by which the friction level follows the velocity [s].
        delay: Time by which the recorded torque is late [s].
        stribeck_exponent: Exponent of the falling part, for both directions.
        sharpness: Share of the bristle that yields abruptly instead of gradually, 0 to 1; of friction that creeps, how
            abruptly it turns over.
        spread: Quotient of the stiffnesses of its neighbouring elements, at least 1.
        creep_velocity: v_c [rad/s], about which dry friction turns over without ever holding; 0 for a bristle.
        creep_lead: Time by which such friction is ahead of the velocity [s].
    """

    inertia: float
    gravity: tuple[float, float]
    offset: float
    forward: tuple[float, float, float, float]
    reverse: tuple[float, float, float, float]
    sigma_0: float
    sigma_1: float = 0.0
    lag: float = 0.0
    delay: float = 0.0
    stribeck_exponent: float = 2.0
    sharpness: float = 0.0
    spread: float = 1.0
    creep_velocity: float = 0.0
    creep_lead: float = 0.0

    @property
    def level(self) -> float:
        """Mean Coulomb torque of both directions [N·m]."""
        return 0.5 * (self.forward[0] + self.reverse[0])

    @property
    def bristle_level(self) -> float:
        """Torque by which the travel of a bristle is measured [N·m]: the Coulomb torque, and no less than half of the
        static friction, whose fall over all of the motion may have taken its place."""
        return max(self.level, 0.25 * (self.forward[1] + self.reverse[1]))

    def to_slots(self) -> FloatArray:
        """Numbers in the order that the kernel takes."""
        exponent = self.stribeck_exponent
        curves = (*self.forward, exponent, *self.reverse, exponent)
        bristle = (self.sigma_0, self.sigma_1, self.lag, self.sharpness, self.spread)
        values = (self.inertia, *curves, *bristle, self.creep_velocity, self.creep_lead)
        assert len(values) == len(FRICTION_SLOTS)
        return np.array(values)

    def compute_gravity_torque(self, position: FloatArray, rotary: bool) -> FloatArray:
        """Gravity and offset at `position` [N·m]."""
        if not rotary:
            return np.full_like(position, self.offset)
        return self.compute_static_torque(np.cos(position), np.sin(position))

    def compute_static_torque(self, cosine: FloatArray, sine: FloatArray) -> FloatArray:
        """Gravity and offset where cosine and sine of the position are known [N·m]."""
        return self.gravity[0] * cosine + self.gravity[1] * sine + self.offset


@dataclass(frozen=True)
class Contribution:
    """What effects add to the joint along one recording.

    Attributes:
        additive: Torque that opposes the drive [N·m]. Shape (n,), or 0.
        level: Torque added to the dry friction level [N·m]. Shape (n,), or 0.
        delay: Time by which the recorded torque is late [s], on top of the plant's.
        lags: Time constants of low passes, one after the other, through which the recorded torque acts [s]; in
            conjugate pairs where it overshoots.
        plant: Fields of `Plant` to replace.
    """

    additive: FloatArray | float = 0.0
    level: FloatArray | float = 0.0
    delay: float = 0.0
    lags: tuple[complex, ...] = ()
    plant: dict[str, Any] = field(default_factory=dict)

    def __add__(self, other: Contribution) -> Contribution:
        return Contribution(
            self.additive + other.additive,
            self.level + other.level,
            self.delay + other.delay,
            self.lags + other.lags,
            {**self.plant, **other.plant},
        )


@dataclass(frozen=True)
class Observer:
    """How tightly the simulation is held to the recording.

    Attributes:
        bandwidth: omega of the second-order observer [rad/s].
        rest_speed: Below it the joint counts as resting [rad/s].
        leak: Rate at which the position of a resting model returns to the recorded one [1/s].
        step: Longest substep in radians of the bristle's own oscillation, where rows would show it.
        width: Width of the windows over which the missing torque is averaged [s], at least.
        as_recorded: Whether the missing torque is what the recorded one lacks, before the lags through which both act,
            or what the joint lacks behind them. The noise of a row must not depend on the lags, else the noisier side
            asks for others: that of a torque does not before them, that of a position behind them.
    """

    bandwidth: float = 100.0
    rest_speed: float = 3e-3
    leak: float = 200.0
    step: float = 0.12
    width: float = JOINT.row_width
    as_recorded: bool = True

    @property
    def row_width(self) -> float:
        """Width of a row's window: wide enough for its noise, and for the observer to have followed [s]."""
        return max(self.width, JOINT.settled / self.bandwidth)

    def compute_return(self, track: Track, plant: Plant, observation: Observation) -> FloatArray:
        """Compute how fast the position of a resting model goes back to the recorded one, besides its velocity [rad/s].

        Shape (n,). A model that creeps returns by itself.
        """
        resting = np.maximum(np.abs(track.velocity), np.abs(observation.velocity)) < self.rest_speed
        leak = self.leak if plant.creep_velocity == 0.0 else 0.0
        result: FloatArray = leak * resting * (track.position - observation.position)
        return result


class Observation(NamedTuple):
    """One run of the observer. Arrays of shape (n,).

    Attributes:
        missing: Torque that the model lacks, where the observer says so [N·m].
        position: Position of the model [rad].
        velocity: Velocity of the model [rad/s].
        bristle: Torque of the bristle [N·m].
    """

    missing: FloatArray
    position: FloatArray
    velocity: FloatArray
    bristle: FloatArray


@dataclass
class Count:
    """How many joints were simulated along a recording."""

    joints: int = 0


_counts: list[Count] = []


@contextmanager
def count_joints() -> Iterator[Count]:
    """Count the joints that are simulated meanwhile, in any thread: the work of a diagnosis, whatever the machine."""
    counted = Count()
    _counts.append(counted)
    try:
        yield counted
    finally:
        _counts.remove(counted)


class Job(NamedTuple):
    """One simulation to run."""

    track: Track
    plant: Plant
    contribution: Contribution


def simulate_all(jobs: Sequence[Job], observer: Observer, gains: tuple[float, float]) -> list[Observation]:
    """Run many simulations on the available cores, several in one call of the kernel, in the order given.

    Args:
        jobs: The simulations.
        observer: Observer settings.
        gains: K [N·m/rad] and D [N·m·s/rad].
    """
    return [Observation(*one) for one in _run_all(jobs, observer, gains, seen=4)]


def compute_missing_torques(jobs: Sequence[Job], observer: Observer, gains: tuple[float, float]) -> list[FloatArray]:
    """Compute what `simulate_all` gives as `missing` alone, which is faster. Shapes (n,)."""
    return [missing for (missing,) in _run_all(jobs, observer, gains, seen=1)]


def _run_all(
    jobs: Sequence[Job], observer: Observer, gains: tuple[float, float], seen: int
) -> list[tuple[FloatArray, ...]]:
    """The first so many signals of an observation, for each job."""
    settings = (*gains, observer.rest_speed, observer.leak)
    for one in _counts:
        one.joints += len(jobs)
    groups: dict[int, list[int]] = {}
    for index, job in enumerate(jobs):
        groups.setdefault(id(job.track.substeps), []).append(index)
    batches = [part[i : i + LANES[-1]] for part in groups.values() for i in range(0, len(part), LANES[-1])]
    result: dict[int, tuple[FloatArray, ...]] = {}
    runs = run_in_threads(lambda batch: _simulate([jobs[i] for i in batch], observer, settings, seen), batches)
    for batch, observations in zip(batches, runs, strict=True):
        result |= dict(zip(batch, observations, strict=True))
    return [result[index] for index in range(len(jobs))]


def _simulate(
    jobs: Sequence[Job], observer: Observer, settings: tuple[float, ...], seen: int
) -> list[tuple[FloatArray, ...]]:
    """Run simulations of tracks of one length, no more than the kernel has lanes."""
    first, lanes = jobs[0].track, choose_lanes(len(jobs))
    assert first.substeps.size == first.size, "the track is none of a problem: observer_for fixes its substeps"
    out = np.empty((seen, len(lanes), first.size))
    signals, rows = _stack_signals(jobs, lanes)
    observe(signals, rows, stack_plants(jobs, lanes), np.array([first.dt, *settings]), first.substeps, lanes, out)
    undone = [job.contribution.lags if observer.as_recorded else () for job in jobs]
    return [(undo_lags(out[0, lane], lags, first.dt), *out[1:, lane]) for lane, lags in enumerate(undone)]


def choose_lanes(count: int) -> tuple[int, ...]:
    """The fewest lanes of a kernel that hold `count` joints; those left over repeat the last one."""
    return tuple(range(next(lanes for lanes in LANES if lanes >= count)))


def stack_plants(jobs: Sequence[Job], lanes: tuple[int, ...]) -> FloatArray:
    """Numbers of the plant of each lane. Shape (18, n_lanes)."""
    each = [_replace_plant(job).to_slots() for job in jobs]
    return np.stack([each[min(lane, len(jobs) - 1)] for lane in lanes], axis=1)


def _replace_plant(job: Job) -> Plant:
    return replace(job.plant, **job.contribution.plant) if job.contribution.plant else job.plant


def _stack_signals(jobs: Sequence[Job], lanes: tuple[int, ...]) -> tuple[tuple[FloatArray, ...], NDArray[np.int64]]:
    """Position, velocity, torque and level as `observe` takes them, and which row of each is a lane's.

    Points of a Jacobian differ by one parameter: most of them share all signals.
    """
    keys = [(id(job.track), _key_drive(job), _identify(job.contribution.level)) for job in jobs]
    tracks, driven, levels = (dict(zip(column, jobs, strict=True)) for column in zip(*keys, strict=True))
    recorded: dict[tuple[object, ...], FloatArray] = {}
    position, velocity = (
        np.stack([getattr(job.track, n) for job in tracks.values()]) for n in ("position", "velocity")
    )
    torque = np.stack([_compute_torque(job, recorded) for job in driven.values()])
    level = np.stack([broadcast_level(job) for job in levels.values()])
    places = [{key: row for row, key in enumerate(table)} for table in (tracks, tracks, driven, levels)]
    each = [[place[key] for place, key in zip(places, (one[0], *one), strict=True)] for one in keys]
    rows = np.array([each[min(lane, len(jobs) - 1)] for lane in lanes]).T.copy()
    return (position, velocity, torque, level), rows


def broadcast_level(job: Job) -> FloatArray:
    """Torque that effects add to the dry friction level [N·m]. Shape (n,)."""
    return np.broadcast_to(np.asarray(job.contribution.level, dtype=np.float64), job.track.position.shape)


def _key_drive(job: Job) -> tuple[object, ...]:
    """Return what the torque of a simulation depends on, as a key."""
    plant, added = _replace_plant(job), job.contribution
    return id(job.track), plant.delay + added.delay, added.lags, plant.gravity, plant.offset, _identify(added.additive)


def _identify(values: FloatArray | float) -> object:
    """Identify equal inputs: a number by its value, an array by its object."""
    return id(values) if isinstance(values, np.ndarray) else ("number", float(values))


def compute_torque(job: Job) -> FloatArray:
    """Torque that drives the bristle: the recorded one less gravity, offset and what effects add. Shape (n,)."""
    return _compute_torque(job, {})


def _compute_torque(job: Job, recorded: dict[tuple[object, ...], FloatArray]) -> FloatArray:
    """The same, with recorded torques by track, delay and lags where they are known."""
    track, plant, added = job.track, _replace_plant(job), job.contribution
    delay = plant.delay + added.delay
    key = (id(track), delay, added.lags)
    if key not in recorded:
        recorded[key] = apply_lags(shift(track.torque, delay / track.dt), added.lags, track.dt)
    held = plant.compute_static_torque(*track.waves) if track.rotary else plant.offset
    result: FloatArray = recorded[key] - held - added.additive
    return result
