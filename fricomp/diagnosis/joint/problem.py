"""The estimation problem of one diagnosis: recordings, observer, and what a row of the residual weighs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import cycle, islice

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, uniform_filter1d
from scipy.signal import lfilter

from fricomp.root_mean_square import compute_rms

from ..inputs.settings import INPUT
from ..inputs.track import FloatArray, Track, differentiate
from .base import unpack
from .kernel import LANES
from .observer import Contribution, Job, Observation, Observer, Plant, compute_missing_torques, simulate_all
from .rows import RowGrid
from .settings import JOINT

__all__ = ["Problem", "Weights", "build_problem"]

_SIGNALS = 4
"""Of a simulation that are held until all at once are done: what effects add, and what it lacks."""

# Torque that effects add along each recording, at the parameters of base and effects.
Effects = Callable[[FloatArray], list[Contribution]]


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
        """Rows of all recordings as one vector of about unit variance."""
        parts = [(r - m) / s for r, m, s in zip(rows, self.mean, self.spread, strict=True)]
        return np.concatenate([np.convolve(self.whitener, part)[: part.size] for part in parts])

    def unweigh(self, vector: FloatArray) -> list[FloatArray]:
        """Rows of each recording, about their mean [N·m], of a weighted vector. Shapes (n_rows,)."""
        parts = np.split(vector, np.cumsum([one.size for one in self.spread])[:-1])
        return [lfilter([1.0], self.whitener, part) * s for part, s in zip(parts, self.spread, strict=True)]

    def whiten(self, columns: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Columns of one recording's rows through the whitening filter, which starts from nothing. Shape (n, k)."""
        result: NDArray[np.complex128] = self.whitener[0] * columns
        for lag, weight in enumerate(self.whitener[1:], start=1):
            result[lag:] += weight * columns[:-lag]
        return result


@dataclass(frozen=True)
class Problem:
    """Everything needed to turn parameters into residual rows.

    Attributes:
        tracks: The recordings.
        grids: Their rows.
        observer: Observer settings.
        gains: K [N·m/rad] and D [N·m·s/rad].
        weights: Null statistics of the rows; None before they are known.
    """

    tracks: tuple[Track, ...]
    grids: tuple[RowGrid, ...]
    observer: Observer
    gains: tuple[float, float]
    weights: Weights | None = None

    def observe(self, jobs: Sequence[Job]) -> list[Observation]:
        """Run simulations with this problem's observer."""
        return simulate_all(jobs, self.observer, self.gains)

    def observe_all(
        self, plants: Sequence[Plant], contributions: Sequence[Sequence[Contribution]]
    ) -> list[list[Observation]]:
        """Observe every recording for every plant."""
        flat, n = self.observe(self._list_jobs(plants, contributions)), len(self.tracks)
        return [flat[i : i + n] for i in range(0, len(flat), n)]

    @cached_property
    def usual_speed(self) -> float:
        """Speed that the joint hardly exceeds in most of its motion [rad/s] or [m/s]: a few fast strokes say nothing of
        how far a curve over the speed is known."""
        speed = np.concatenate([np.abs(track.velocity) for track in self.tracks])
        slides = speed[speed > self.observer.rest_speed]
        return float(np.quantile(slides, JOINT.usual_motion)) if slides.size else float(np.max(speed, initial=0.0))

    @property
    def count_at_once(self) -> int:
        """Number of simulations of all recordings that are held in memory together."""
        samples = sum(track.size for track in self.tracks)
        return max(JOINT.threads * LANES[1], JOINT.most_held // (_SIGNALS * samples))

    def compute_vectors(
        self, plants: Sequence[Plant], contributions: Iterable[Sequence[Contribution]]
    ) -> list[FloatArray]:
        """The residual as one weighted vector, for every plant. Shapes (m,).

        Args:
            plants: The joints.
            contributions: What effects add to each along every recording; of long recordings better not all at once.
        """
        pairs, vectors = zip(plants, contributions, strict=True), list[FloatArray]()
        while batch := list(islice(pairs, self.count_at_once)):
            vectors += self._compute_vectors(*zip(*batch, strict=True))
            batch.clear()  # before the next ones are made
        return vectors

    def _compute_vectors(
        self, plants: Sequence[Plant], contributions: Sequence[Sequence[Contribution]]
    ) -> list[FloatArray]:
        flat = self.compute_missing(self._list_jobs(plants, contributions))
        rows = [grid.average(one) for grid, one in zip(cycle(self.grids), flat, strict=False)]
        n = len(self.tracks)
        return [self._weigh(rows[i : i + n]) for i in range(0, len(rows), n)]

    def compute_missing(self, jobs: Sequence[Job]) -> list[FloatArray]:
        """The torque that the model lacks in each of these simulations. Shapes (n,)."""
        return compute_missing_torques(jobs, self.observer, self.gains)

    def _list_jobs(self, plants: Sequence[Plant], contributions: Sequence[Sequence[Contribution]]) -> list[Job]:
        return [
            Job(track, plant, contribution)
            for plant, per_track in zip(plants, contributions, strict=True)
            for track, contribution in zip(self.tracks, per_track, strict=True)
        ]

    def compute_rows(self, observations: Sequence[Observation]) -> list[FloatArray]:
        """Missing torque at the rows of each recording [N·m]."""
        return [grid.average(one.missing) for grid, one in zip(self.grids, observations, strict=True)]

    def compute_vector(self, observations: Sequence[Observation]) -> FloatArray:
        """The residual as one weighted vector. Shape (m,)."""
        return self._weigh(self.compute_rows(observations))

    def unweigh(self, vector: FloatArray) -> list[FloatArray]:
        """Rows of each recording [N·m] or [N] of a residual. Shapes (n_rows,)."""
        ends = np.cumsum([grid.centres.size for grid in self.grids])[:-1]
        return np.split(vector, ends) if self.weights is None else self.weights.unweigh(vector)

    def _weigh(self, rows: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate(rows) if self.weights is None else self.weights.apply(rows)

    def build_residual(self, effects: Effects) -> Callable[[Sequence[FloatArray]], list[FloatArray]]:
        """The residual vector as a function of base and effect parameters."""

        def evaluate(points: Sequence[FloatArray]) -> list[FloatArray]:
            plants = [unpack(point) for point in points]
            return self.compute_vectors(plants, (effects(point) for point in points))

        return evaluate

    def add_nothing(self, _: FloatArray) -> list[Contribution]:
        """No effects."""
        return [Contribution()] * len(self.tracks)

    def cut_samples_for(self, *plants: Plant) -> Problem:
        """Return the same problem with substeps as fine as any of the `plants` needs."""
        tracks = []
        for track in self.tracks:
            needed = [_choose_substeps(track, plant, self.observer, self.gains) for plant in plants]
            tracks.append(replace(track, substeps=np.max(needed, axis=0)))
        return replace(self, tracks=tuple(tracks))

    def observe_finite(self, plant: Plant, effects: Sequence[Contribution]) -> list[Observation]:
        """Simulate a plant along every recording.

        Raises:
            FloatingPointError: The plant runs away in simulation.
        """
        (runs,) = self.observe_all([plant], [effects])
        if not all(np.isfinite(run.position).all() and np.isfinite(run.velocity).all() for run in runs):
            raise FloatingPointError("a joint that the recording hardly determines runs away in simulation")
        return runs

    def improve_velocity(self, plant: Plant, effects: Sequence[Contribution]) -> Problem:
        """Improve the velocities by simulation.

        One stays as it is where the model swings by more than the joint moves, as a mass of next to nothing does.

        Raises:
            FloatingPointError: The plant runs away in simulation.
        """
        tracks = []
        for track, run in zip(self.tracks, self.observe_finite(plant, effects), strict=True):
            improved = improve_track(track, run, self.observer.compute_return(track, plant, run))
            moves = max(compute_rms(track.velocity), self.observer.rest_speed)
            tracks.append(track if compute_rms(improved.velocity - track.velocity) > moves else improved)
        return replace(self, tracks=tuple(tracks))


def improve_track(track: Track, observation: Observation, returning: FloatArray) -> Track:
    """Replace the velocity of a track by that of the observed model, corrected by the slope of what it missed.

    The slope is taken over a long window where the model misses no more of the position within it than noise, else over
    a short one; where the model misses more there as well, the motion is not the model's, and the velocity is that of
    the encoder alone.

    Args:
        track: The recording.
        observation: Run of the model along it.
        returning: What the observer adds to the velocity of a resting model's position [rad/s]. Left out, a bristle
            that is too soft would say that the joint moves while the encoder stands still, and be kept soft by it.
    """
    missed, modelled = track.position - observation.position, observation.velocity + returning
    noise = track.compute_position_variance(observation.velocity)
    velocity = differentiate(track.position, track.dt)
    for window in (INPUT.velocity_window, JOINT.innovation_window):
        beyond = missed - differentiate(missed, track.dt, window, order=0)
        size = uniform_filter1d(beyond**2, max(1, round(JOINT.innovation_window / track.dt)))
        trust = np.clip(2.0 - size / (JOINT.loud_innovation**2 * noise), 0.0, 1.0)
        velocity = velocity + trust * (modelled + differentiate(missed, track.dt, window) - velocity)
    return replace(track, velocity=velocity)


def build_problem(tracks: Sequence[Track], plant: Plant, observer: Observer) -> Problem:
    """Build the problem for a first plant, with gains that hold the model even where friction falls steepest."""
    inertia, omega = plant.inertia, observer.bandwidth
    slope = max(0.858 * (s - c) / v - f for c, s, v, f in (plant.forward, plant.reverse))
    gains = (inertia * omega**2, 2.0 * inertia * omega + max(slope, 0.0))
    width = observer.row_width
    grids = [RowGrid.build(t, width, width / JOINT.row_width * JOINT.row_step, 0.5) for t in tracks]
    return Problem(tuple(tracks), tuple(grids), observer, gains).cut_samples_for(plant)


def _choose_substeps(track: Track, plant: Plant, observer: Observer, gains: tuple[float, float]) -> NDArray[np.int64]:
    """Steps of each sample: many while the bristle may be stretched, few where it has long yielded. Shape (n,).

    A bristle at its level follows the speed at once, and the stiffness that asks for short steps is gone; friction that
    creeps has no bristle. Rows do not show how a bristle swings that is much quicker than they are wide: its steps need
    only be stable. Where the joint has yielded they may be twice as long, but no longer: a model that sticks for longer
    than the joint must not be shaken loose by its steps. Viscous friction and the damping of a bristle are exact for
    steps of any length.
    """
    stiffness = 3.0 * plant.sigma_0 if plant.creep_velocity == 0.0 else 0.0
    swing = np.sqrt((stiffness + gains[0]) / plant.inertia)
    seen = min(swing / observer.step, JOINT.row_substeps / observer.row_width)
    stable = swing / JOINT.stable_substep
    fastest = gains[1] / plant.inertia / JOINT.held_substep
    fine = int(np.clip(np.ceil(max(seen, stable, fastest) * track.dt), *JOINT.fine_substeps))
    coarse = int(np.clip(np.ceil(max(0.5 * stable, fastest) * track.dt), JOINT.coarse_substeps, fine))
    direction = np.sign(track.velocity) * (np.abs(track.velocity) > JOINT.certain_sliding * observer.rest_speed)
    turned = np.concatenate([[True], direction[1:] != direction[:-1]]) | (direction == 0.0)
    index = np.arange(track.size)
    since = track.position - track.position[np.maximum.accumulate(np.where(turned, index, 0))]
    yielded = (direction != 0.0) & (np.abs(since) > JOINT.yielded_travel * JOINT.softest_bristle)
    margin = max(1, round(JOINT.turning_margin / track.dt))
    return np.where(binary_erosion(yielded, np.ones(2 * margin + 1)), coarse, fine)
