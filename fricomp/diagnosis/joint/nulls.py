"""Nulls: the fitted model re-simulated with this recording's noise, through the same chain as the recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import repeat

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d
from scipy.optimize import nnls

from ..inputs.delay import shift
from ..inputs.spikes import take_out_spikes
from ..inputs.track import FloatArray, TorqueNoise, Track, differentiate
from .kernel import LANES
from .observer import Contribution, Job, Observation, Plant
from .problem import Problem, Weights, improve_track
from .settings import JOINT
from .step_answer import StepAnswer, simulate_step_answers

_SIGNALS = 12
"""Signals of a null that are held while it is simulated."""


@dataclass(frozen=True)
class Nulls:
    """Rows of simulated recordings in which nothing is missing.

    Attributes:
        rows: For each recording, shape (n_nulls, n_rows) [N·m].
        weights: Their mean, spread and correlation.
        of_torque: Part of their variation that comes from noise of the torque; the rest is of the position.
        quiet: Whether the recordings have hardly any noise, as simulators write them.
    """

    rows: tuple[FloatArray, ...]
    weights: Weights
    of_torque: float = 1.0
    quiet: bool = False

    @property
    def count(self) -> int:
        """Number of nulls."""
        return int(self.rows[0].shape[0])

    def scale(self, factor: float) -> Nulls:
        """The same nulls with noise larger by `factor`."""
        rows = tuple(m + factor * (r - m) for r, m in zip(self.rows, self.weights.mean, strict=True))
        spread = tuple(factor * s for s in self.weights.spread)
        return replace(self, rows=rows, weights=replace(self.weights, spread=spread))

    def build_vectors(self) -> list[FloatArray]:
        """Each null as a weighted residual vector."""
        return [self.weights.apply([rows[i] for rows in self.rows]) for i in range(self.count)]


def make_nulls(problem: Problem, plant: Plant, effects: Sequence[Contribution], *, count: int, seed: int) -> Nulls:
    """Simulate `count` nulls of `plant` with `effects`; their noise is matched to that of the residual.

    Raises:
        FloatingPointError: The plant does not simulate with that noise.
    """
    data = problem.compute_rows(problem.observe_all([plant], [effects])[0])
    calm = replace(problem, tracks=tuple(replace(track, torque=_smooth(track)) for track in problem.tracks))
    truth = calm.observe_all([plant], [effects])[0]
    applied = tuple(
        track.torque + shift(one.missing, -plant.delay / track.dt)
        for track, one in zip(calm.tracks, truth, strict=True)
    )
    answers = tuple(
        simulate_step_answers(job, one, torque, count=max(count, JOINT.matching_nulls), seed=seed)
        for job, one, torque in zip(map(Job, problem.tracks, repeat(plant), effects), truth, applied, strict=True)
    )
    chain = _Chain(problem, plant, tuple(effects), tuple(truth), applied, answers)
    noises, parts = zip(*[_match_noise(chain, index, rows, seed) for index, rows in enumerate(data)], strict=True)
    rows = [chain.simulate_rows(index, noise, count, seed + 1) for index, noise in enumerate(noises)]
    quietest = np.quantile(np.concatenate([np.std(one, axis=0) for one in rows]), JOINT.quiet_rows)
    quiet = bool(quietest < JOINT.quiet * plant.level)
    rows = _blur(rows, JOINT.finest * plant.level, seed) if quiet else rows
    weights = _build_weights(rows, _compute_presliding(problem, plant, effects))
    return Nulls(tuple(rows), weights, float(np.mean(parts)), quiet)


@dataclass(frozen=True)
class _Chain:
    """What makes a null: the joint moved as the fitted model says, and its sensors.

    Attributes:
        problem: The recordings and their rows.
        plant: The fitted joint.
        effects: What effects add along each recording.
        truth: The model's motion under each recording's torque without noise.
        applied: Torque that moves the joint so, for each recording [N·m]. Shapes (n,).
        answers: What the loop makes of the encoder's steps, for each recording; empty where it is not heard.
    """

    problem: Problem
    plant: Plant
    effects: tuple[Contribution, ...]
    truth: tuple[Observation, ...]
    applied: tuple[FloatArray, ...]
    answers: tuple[list[StepAnswer], ...]

    def simulate_rows(self, index: int, noise: TorqueNoise, count: int, seed: int) -> FloatArray:
        """Rows of `count` nulls of one recording, shape (count, n_rows) [N·m]."""
        track = self.problem.tracks[index]
        rng = np.random.default_rng([seed, index])
        stepless = replace(track, resolution=0.0)  # what answers show has the encoder's steps already
        heard = [(stepless, one.position, self.applied[index] + one.torque) for one in self.answers[index][:count]]
        moved = heard or [(track, self.truth[index].position, self.applied[index])] * count
        at_once = max(LANES[1], JOINT.most_held // (_SIGNALS * track.size))
        own = track.position_noise.measure_own(track.resolution)
        real = TorqueNoise(0.0, 0.0, 0.0) if heard else track.torque_noise.take_out(noise)
        parts = [moved[i : i + at_once] for i in range(0, len(moved), at_once)]
        return np.concatenate(
            [self._simulate(index, [_draw_null(*each, (noise, own, real), rng) for each in part]) for part in parts]
        )

    def _simulate(self, index: int, nulls: list[Track]) -> FloatArray:
        """Rows of nulls of one recording, from what their sensors show (taken). Shape (n_nulls, n_rows) [N·m]."""
        effect = self.effects[index]
        first = self.problem.observe([Job(null, self.plant, effect) for null in nulls])
        if not all(np.all(np.isfinite(run.missing)) for run in first):
            raise FloatingPointError("a joint that the recording hardly determines does not simulate with its noise")
        returning, improved = self.problem.observer.compute_return, list[Track]()
        for run in first:  # of a long recording all of these are hundreds of megabytes: none is kept for longer
            null = nulls.pop(0)
            improved.append(improve_track(null, run, returning(null, self.plant, run)))
        del first, run, null
        missing = self.problem.compute_missing([Job(null, self.plant, effect) for null in improved])
        return np.stack([self.problem.grids[index].average(one) for one in missing])


def _match_noise(chain: _Chain, index: int, data: FloatArray, seed: int) -> tuple[TorqueNoise, float]:
    """Find the torque noise with which the rows of nulls vary as those of the data do, over one and several rows, and
    what part of that it is.

    Samples alone cannot tell noise from torque that a controller really made of the encoder's steps; rows can, since
    real torque moves the joint.
    """
    track, slides = chain.problem.tracks[index], _find_sliding(chain.problem, index)
    seen = track.torque_noise
    size = seen.size or 1e-3 * float(np.std(track.torque))
    memory = seen.memory if seen.coloured > 0.0 else JOINT.usual_memory
    kinds = (TorqueNoise(0.0, 0.0, 0.0), TorqueNoise(size, 0.0, 0.0, seen.freedom), TorqueNoise(0.0, size, memory))
    without, white, coloured = (
        _compute_variation(chain.simulate_rows(index, kind, JOINT.matching_nulls, seed), slides) for kind in kinds
    )
    target = _compute_variation(data[None], slides)
    columns = np.stack([white - without, coloured - without], axis=1) / target[:, None]
    found, _ = nnls(np.maximum(columns, 0.0), np.maximum(target - without, 0.0) / target)
    noise = TorqueNoise(size * float(np.sqrt(found[0])), size * float(np.sqrt(found[1])), memory, seen.freedom)
    again = _compute_variation(chain.simulate_rows(index, noise, JOINT.matching_nulls, seed), slides)
    factor = float(np.clip(np.sqrt(target[0] / again[0]), *JOINT.noise_correction))
    matched = noise._replace(white=factor * noise.white, coloured=factor * noise.coloured)
    return matched, float(np.clip(1.0 - without[0] / target[0], 0.0, 1.0))


def _blur(rows: Sequence[FloatArray], size: float, seed: int) -> list[FloatArray]:
    """Rows each of which has noise of `size` at least, so that nothing finer counts [N·m]."""
    rng = np.random.default_rng([seed, len(rows)])
    more = [np.sqrt(np.maximum(size**2 - np.var(one, axis=0), 0.0)) for one in rows]
    return [one + own * rng.standard_normal(one.shape) for one, own in zip(rows, more, strict=True)]


def _find_sliding(problem: Problem, index: int) -> NDArray[np.bool_]:
    """Find the rows in which a recorded joint slides throughout, or all rows where these are few. Shape (n_rows,).

    A joint that sticks takes up the noise of its torque in the bristle; how often one is about to stick, nulls of a
    loop need not repeat exactly, and a median over both kinds of rows would depend on it.
    """
    moves = (np.abs(problem.tracks[index].velocity) > problem.observer.rest_speed).astype(np.float64)
    rows = problem.grids[index].average(moves) > JOINT.throughout
    return rows if np.count_nonzero(rows) >= JOINT.enough_rows else np.ones_like(rows)


def _compute_variation(rows: FloatArray, slides: NDArray[np.bool_]) -> FloatArray:
    """Squared typical second difference over one, two and four rows, which no smooth torque reaches [(N·m)²]."""
    spans = [(rows[:, 2 * k :] - 2.0 * rows[:, k:-k] + rows[:, : -2 * k])[:, slides[k:-k]] for k in (1, 2, 4)]
    return np.array([max(float(np.median(np.abs(one))) ** 2, 1e-30) for one in spans])


def _compute_presliding(problem: Problem, plant: Plant, effects: Sequence[Contribution]) -> list[FloatArray]:
    """Compute how far each row depends on the law of the bristle, which no recording fixes exactly [N·m].

    The base has one bristle of one stiffness; real presliding has a spectrum of them [albender2005gms]. The rows
    after reversals are trusted less, in proportion to what another stiffness would change there, and another velocity
    about which friction that creeps turns over.
    """
    variants = [
        replace(plant, sigma_0=plant.sigma_0 * factor, creep_velocity=plant.creep_velocity / slower)
        for factor, slower in (
            (1.0 / JOINT.stiffness_doubt, 1.0 / JOINT.creep_doubt),
            (JOINT.stiffness_doubt, JOINT.creep_doubt),
        )
    ]
    softer, stiffer = problem.observe_all(variants, [effects, effects])
    return [
        0.5 * np.abs(a - b) for a, b in zip(problem.compute_rows(softer), problem.compute_rows(stiffer), strict=True)
    ]


def _smooth(track: Track) -> FloatArray:
    """Recorded torque without most of its noise [N·m]."""
    width = max(3, 2 * round(JOINT.torque_window / track.dt / 2) + 1)
    window = np.hanning(width + 2)[1:-1]
    smooth: FloatArray = np.convolve(np.pad(track.torque, width // 2, mode="edge"), window / window.sum(), mode="valid")
    return smooth


def _draw_null(
    track: Track,
    position: FloatArray,
    applied: FloatArray,
    noises: tuple[TorqueNoise, float, TorqueNoise],
    rng: np.random.Generator,
) -> Track:
    """Record a joint that `applied` moves along `position`, with fresh noise, rounding, a small delay and the same rows
    missing. Noise of the position shows in rows of rest, where a bristle takes up that of a torque.

    What of the noise was torque that moved the joint is known where there are rows, and lost between them.
    """
    noise, own, real = noises
    torque = shift(applied, rng.normal(0.0, JOINT.delay_spread) / track.dt)
    if track.position_noise.jitter > 0.0:
        late = track.position_noise.jitter / track.dt * rng.standard_normal(track.size)
        torque, position = torque + late * np.gradient(torque), position + late * np.gradient(position)
    drawn = take_out_spikes(noise.draw(track.size, rng), max(noise.size, track.torque_noise.size))
    torque = track.fill_rows(track.take_rows(torque + track.unrest * drawn))
    if track.missing.any() and real.size > 0.0:
        moving = track.unrest * real.draw(track.size, rng)
        torque = torque + track.fill_rows(moving) - moving
    position = track.take_rows(position)
    if own > 0.0:
        position = position + own * rng.standard_normal(position.size)
    if track.resolution > 0.0:
        position = np.round(position / track.resolution + rng.uniform()) * track.resolution
    position = track.fill_rows(position)
    return replace(track, position=position, torque=torque, velocity=differentiate(position, track.dt))


def _build_weights(rows: Sequence[FloatArray], presliding: Sequence[FloatArray]) -> Weights:
    mean = tuple(r.mean(axis=0) for r in rows)
    noise = [compute_row_spread(r, m) for r, m in zip(rows, mean, strict=True)]
    spread = tuple(np.hypot(s, JOINT.law_doubt * p) for s, p in zip(noise, presliding, strict=True))
    unit = [(r - m) / s for r, m, s in zip(rows, mean, noise, strict=True)]
    return Weights(mean, spread, _build_whitener(unit))


def compute_row_spread(rows: FloatArray, mean: FloatArray) -> FloatArray:
    """Spread of each row, steadied by its neighbours; half of the nulls' own bias counts as uncertain."""
    spread = np.hypot(rows.std(axis=0, ddof=1), 0.5 * mean)
    steady = 0.5 * np.maximum(spread, median_filter(spread, 5)) + 0.5 * uniform_filter1d(spread, 3)
    floor: FloatArray = np.maximum(steady, 0.3 * np.median(spread))
    return floor


def _build_whitener(unit: Sequence[FloatArray]) -> FloatArray:
    """AR filter from the pooled autocorrelation of the nulls, scaled to unit innovation variance."""
    lags = np.array(
        [
            np.mean([np.mean(u[:, lag:] * u[:, : u.shape[1] - lag]) for u in unit])
            for lag in range(JOINT.whitener_order + 1)
        ]
    )
    R = np.array([[lags[abs(i - j)] for j in range(JOINT.whitener_order)] for i in range(JOINT.whitener_order)])
    a = np.linalg.solve(R + 1e-6 * lags[0] * np.eye(JOINT.whitener_order), lags[1:])
    innovation = max(float(lags[0] - a @ lags[1:]), 1e-3 * lags[0])
    result: FloatArray = np.concatenate([[1.0], -a]) / np.sqrt(innovation)
    return result
