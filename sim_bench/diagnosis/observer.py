"""Observed simulation of a recording: what the model lacks, as a torque over time."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import lfilter

from .kernel import FRICTION_SLOTS, LANES, observe
from .track import FloatArray, Track

__all__ = [
    "THREADS",
    "Contribution",
    "Observation",
    "Observer",
    "Plant",
    "ahead_of",
    "behind",
    "lanes_of",
    "simulate_all",
]

THREADS = 2


@dataclass(frozen=True)
class Plant:
    """The joint that the observer simulates.

    Attributes:
        inertia: J [kg·m²] or [kg].
        gravity: Coefficients of cos q and sin q [N·m].
        offset: Constant torque [N·m].
        forward: F_c, F_s [N·m], v_s [rad/s], F_v [N·m·s/rad] for v > 0.
        reverse: The same for v < 0.
        sigma_0: Bristle stiffness [N·m/rad].
        sigma_1: Bristle damping [N·m·s/rad].
        lag: Time by which the friction level follows the velocity [s].
        delay: Time by which the recorded torque is late [s].
        stribeck_exponent: Exponent of the falling part, for both directions.
        sharpness: Share of the bristle that yields abruptly instead of gradually, 0 to 1.
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

    def slots(self) -> FloatArray:
        """Numbers in the order that the kernel takes."""
        exponent = self.stribeck_exponent
        curves = (*self.forward, exponent, *self.reverse, exponent)
        bristle = (self.sigma_0, self.sigma_1, self.lag, self.sharpness, self.spread)
        values = (self.inertia, *curves, *bristle, self.creep_velocity, self.creep_lead)
        assert len(values) == len(FRICTION_SLOTS)
        return np.array(values)

    def gravity_torque(self, position: FloatArray, rotary: bool) -> FloatArray:
        """Gravity and offset at `position` [N·m]."""
        if not rotary:
            return np.full_like(position, self.offset)
        return self.static_torque(np.cos(position), np.sin(position))

    def static_torque(self, cosine: FloatArray, sine: FloatArray) -> FloatArray:
        """Gravity and offset where cosine and sine of the position are known [N·m]."""
        return self.gravity[0] * cosine + self.gravity[1] * sine + self.offset


@dataclass(frozen=True)
class Contribution:
    """What effects add to the joint along one recording.

    Attributes:
        additive: Torque that opposes the drive [N·m]. Shape (n,), or 0.
        level: Torque added to the dry friction level [N·m]. Shape (n,), or 0.
        delay: Time by which the recorded torque is late [s], on top of the plant's.
        lags: Time constants of low passes, one after the other, through which the recorded torque acts [s].
        plant: Fields of `Plant` to replace.
    """

    additive: FloatArray | float = 0.0
    level: FloatArray | float = 0.0
    delay: float = 0.0
    lags: tuple[float, ...] = ()
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
        step: Longest substep in radians of the bristle's own oscillation.
    """

    bandwidth: float = 100.0
    rest_speed: float = 3e-3
    leak: float = 200.0
    step: float = 0.12

    def returning(self, track: Track, plant: Plant, observation: Observation) -> FloatArray:
        """How fast the position of a resting model goes back to the recorded one, beside its velocity [rad/s].

        Shape (n,). A model that creeps returns by itself.
        """
        resting = np.maximum(np.abs(track.velocity), np.abs(observation.velocity)) < self.rest_speed
        leak = self.leak if plant.creep_velocity == 0.0 else 0.0
        result: FloatArray = leak * resting * (track.position - observation.position)
        return result


class Observation(NamedTuple):
    """One run of the observer. Arrays of shape (n,).

    Attributes:
        missing: Torque that the model lacks, beside the recorded one, where both pass the same lags [N·m].
        position: Of the model [rad].
        velocity: Of the model [rad/s].
        bristle: Its torque [N·m].
    """

    missing: FloatArray
    position: FloatArray
    velocity: FloatArray
    bristle: FloatArray


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
    settings = (*gains, observer.rest_speed, observer.leak)
    groups: dict[int, list[int]] = {}
    for index, job in enumerate(jobs):
        groups.setdefault(id(job.track.substeps), []).append(index)
    batches = [part[i : i + LANES] for part in groups.values() for i in range(0, len(part), LANES)]
    result: dict[int, Observation] = {}
    with ThreadPoolExecutor(THREADS) as pool:
        runs = pool.map(lambda batch: _simulate([jobs[i] for i in batch], settings), batches)
        for batch, observations in zip(batches, runs, strict=True):
            result |= dict(zip(batch, observations, strict=True))
    return [result[index] for index in range(len(jobs))]


def _simulate(jobs: Sequence[Job], settings: tuple[float, ...]) -> list[Observation]:
    """Run at most `LANES` simulations of tracks of one length."""
    first, (signals, plants) = jobs[0].track, lanes_of(jobs)
    out = np.empty((4, LANES, first.size))
    observer = np.array([first.dt, *settings])
    observe(signals[0], signals[1], signals[2], signals[3], plants, observer, first.substeps, out)
    return [
        Observation(ahead_of(out[0, lane], job.contribution.lags, first.dt), *out[1:, lane])
        for lane, job in enumerate(jobs)
    ]


def lanes_of(jobs: Sequence[Job]) -> tuple[FloatArray, FloatArray]:
    """What the kernels take of at most `LANES` simulations; lanes left over repeat the last one.

    Returns:
        Position, velocity, torque without gravity and what effects add, and level of each lane, shape (4, LANES, n),
        and the numbers of its plant, shape (18, LANES).
    """
    n = jobs[0].track.size
    assert jobs[0].track.substeps.size == n, "the track is none of a problem: observer_for fixes its substeps"
    signals, plants = np.empty((4, LANES, n)), np.empty((len(FRICTION_SLOTS), LANES))
    for lane in range(LANES):
        track, plant, contribution = jobs[min(lane, len(jobs) - 1)]
        plant = replace(plant, **contribution.plant) if contribution.plant else plant
        plants[:, lane] = plant.slots()
        signals[0, lane], signals[1, lane] = track.position, track.velocity
        held = plant.static_torque(*track.waves) if track.rotary else plant.offset
        torque = shifted(track.torque, (plant.delay + contribution.delay) / track.dt)
        signals[2, lane] = behind(torque, contribution.lags, track.dt) - held - contribution.additive
        signals[3, lane] = contribution.level
    return signals, plants


def shifted(values: FloatArray, samples: float) -> FloatArray:
    """`values` as they will be `samples` later: undoes a delay, by linear interpolation; the ends are held."""
    if samples == 0.0:
        return values
    whole = int(np.floor(samples))
    share, n = samples - whole, values.size
    first = np.clip(whole, -n, n)
    held = np.concatenate([np.repeat(values[:1], max(-first, 0)), values, np.repeat(values[-1:], max(first, 0) + 1)])
    start = max(first, 0)
    return held[start : start + n] * (1.0 - share) + held[start + 1 : start + 1 + n] * share


def behind(values: FloatArray, lags: tuple[float, ...], dt: float) -> FloatArray:
    """`values` as they come through low passes of the first order, held before the first one. Shape (n,)."""
    for lag in lags:
        keep = float(np.exp(-dt / lag))
        values, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return values


def ahead_of(values: FloatArray, lags: tuple[float, ...], dt: float) -> FloatArray:
    """What comes through these low passes as `values`: undoes them, so that a lag takes no noise away. Shape (n,)."""
    for lag in lags:
        keep = float(np.exp(-dt / lag))
        before = np.concatenate([values[:1], values[:-1]])
        values = (values - keep * before) / (1.0 - keep)
    return values
