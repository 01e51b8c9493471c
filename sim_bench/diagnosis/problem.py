"""The estimation problem of one diagnosis: recordings, observer, and what a row of the residual weighs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from .base import unpack
from .observer import Contribution, Job, Observation, Observer, Plant, simulate_all
from .rows import RowGrid
from .track import FloatArray, Track, smooth_derivative

__all__ = ["Problem", "Weights", "observer_for"]

# Torque that effects add along each recording, for their parameters.
Effects = Callable[[FloatArray], list[Contribution]]

_ROW_WIDTH = 0.042  # [s]
_ROW_STEP = 0.020  # [s]
_INNOVATION_WINDOW = 0.061  # [s]


@dataclass(frozen=True)
class Weights:
    """What the rows look like where nothing is missing.

    Attributes:
        mean: Mean of each row [N·m], for each recording. Shapes (n_rows,).
        spread: Standard deviation of each row [N·m], for each recording. Shapes (n_rows,).
        whitener: Coefficients of the AR whitening filter 1 - a_1 z^-1 - ...; shape (order + 1,).
    """

    mean: tuple[FloatArray, ...]
    spread: tuple[FloatArray, ...]
    whitener: FloatArray

    def apply(self, rows: Sequence[FloatArray]) -> FloatArray:
        """Rows of all recordings as one vector of about unit variance, or columns of such vectors."""
        parts = [(r - m) / s for r, m, s in zip(rows, self.mean, self.spread, strict=True)]
        return np.concatenate([lfilter(self.whitener, [1.0], part) for part in parts])


@dataclass(frozen=True)
class Problem:
    """Everything needed to turn parameters into residual rows.

    Attributes:
        tracks: The recordings.
        grids: Their rows.
        observer: Observer settings.
        gains: K [N·m/rad] and D [N·m·s/rad].
        substeps: Substeps of a sample.
        weights: Null statistics of the rows; None before they are known.
    """

    tracks: tuple[Track, ...]
    grids: tuple[RowGrid, ...]
    observer: Observer
    gains: tuple[float, float]
    substeps: int
    weights: Weights | None = None

    def observe(self, jobs: Sequence[Job]) -> list[Observation]:
        """Run simulations with this problem's observer."""
        return simulate_all(jobs, self.observer, self.gains, self.substeps)

    def runs(self, plants: Sequence[Plant], contributions: Sequence[Sequence[Contribution]]) -> list[list[Observation]]:
        """Observe every recording for every plant."""
        jobs = [
            Job(track, plant, contribution)
            for plant, per_track in zip(plants, contributions, strict=True)
            for track, contribution in zip(self.tracks, per_track, strict=True)
        ]
        flat, n = self.observe(jobs), len(self.tracks)
        return [flat[i : i + n] for i in range(0, len(flat), n)]

    def rows(self, observations: Sequence[Observation]) -> list[FloatArray]:
        """Missing torque at the rows of each recording [N·m]."""
        return [grid.of(one.missing) for grid, one in zip(self.grids, observations, strict=True)]

    def vector(self, observations: Sequence[Observation]) -> FloatArray:
        """The residual as one weighted vector. Shape (m,)."""
        rows = self.rows(observations)
        return np.concatenate(rows) if self.weights is None else self.weights.apply(rows)

    def residual(self, effects: Effects, n_base: int) -> Callable[[Sequence[FloatArray]], list[FloatArray]]:
        """The residual vector as a function of base and effect parameters."""

        def evaluate(points: Sequence[FloatArray]) -> list[FloatArray]:
            plants = [unpack(point[:n_base]) for point in points]
            contributions = [effects(point[n_base:]) for point in points]
            return [self.vector(run) for run in self.runs(plants, contributions)]

        return evaluate

    def nothing(self, _: FloatArray) -> list[Contribution]:
        """No effects."""
        return [Contribution()] * len(self.tracks)

    def with_velocity(self, observations: Sequence[Observation]) -> Problem:
        """The same problem with velocities improved by the simulation: its own plus that of the slow innovation."""
        tracks = tuple(improved(track, one) for track, one in zip(self.tracks, observations, strict=True))
        return replace(self, tracks=tracks)


def improved(track: Track, observation: Observation) -> Track:
    """`track` with the velocity of the observed model, corrected by the slope of what it missed."""
    slope = smooth_derivative(track.position - observation.position, track.dt, _INNOVATION_WINDOW)
    return replace(track, velocity=observation.velocity + slope)


def observer_for(tracks: Sequence[Track], plant: Plant, observer: Observer) -> Problem:
    """The problem for a first plant: gains that hold the model through its steepest falling Stribeck slope."""
    inertia, omega = plant.inertia, observer.bandwidth
    slope = max(0.858 * (s - c) / v - f for c, s, v, f in (plant.forward, plant.reverse))
    gains = (inertia * omega**2, 2.0 * inertia * omega + max(slope, 0.0))
    dt = tracks[0].dt
    stiffest = np.sqrt((3.0 * plant.sigma_0 + gains[0]) / inertia)
    fastest = (gains[1] + 3.0 * max(plant.forward[3], plant.reverse[3])) / inertia
    substeps = int(np.clip(np.ceil(max(stiffest / observer.step, fastest / 0.4) * dt), 3, 40))
    scale = max(1.0, 5.0 / (omega * _ROW_WIDTH))
    grids = [RowGrid.build(t, scale * _ROW_WIDTH, scale * _ROW_STEP, 0.5) for t in tracks]
    return Problem(tuple(tracks), tuple(grids), observer, gains, substeps)
