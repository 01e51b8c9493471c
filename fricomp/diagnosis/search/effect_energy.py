"""Energy of what effects add and a plain joint cannot take up: where they show however well that joint is fitted."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from ..effects.structure import Structure
from ..inputs.track import FloatArray, Track, differentiate
from ..joint.observer import Observation, Plant
from ..joint.problem import Problem, build_problem
from ..joint.rows import RowGrid
from .preparation import Baseline
from .settings import SEARCH


def compute_effect_energy(
    baseline: Baseline, structure: Structure, theta: FloatArray, names: Collection[str]
) -> list[FloatArray]:
    """Compute the energy of the effects' torque, over the noise, that a refit of a rigid joint with Stribeck friction
    leaves.

    It is asked of a window about every sample: an impact or a reversal is shorter than the way from row to row. The
    noise is that of a typical row, since some dozens of nulls know the energy of a single one to a quarter only. Where
    the bristle holds, an encoder step stretches it by a torque that says nothing about effects: the noise counts as at
    least that, as far as the joint rests in the window.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        structure: Base and effects.
        theta: Their parameters.
        names: The effects that are asked for.

    Returns:
        Energy of each sample, by recording; 0 where no window fits. Shapes (n_samples,).
    """
    problem, plant = baseline.problem, structure.unpack_plant(theta)
    tight = _hold_tightly(problem, plant)
    complete, without = structure.observe_with_and_without(tight, theta, names)
    torque, columns = [], []
    for i, (track, grid) in enumerate(zip(tight.tracks, tight.grids, strict=True)):
        rests = (np.abs(track.velocity) < problem.observer.rest_speed).astype(float)
        level = _measure_noise(baseline.nulls.weights.spread[i], problem.grids[i].average(rests))
        step = plant.sigma_0 * track.resolution / np.sqrt(12.0)
        noise = np.hypot(level, grid.average_everywhere(rests) * step)
        added = _centre(without[i].missing - complete[i].missing)
        torque.append(grid.average_everywhere(added) / noise)
        columns.append(_build_plain_joint(track, grid, without[i], plant) / noise[:, None])
    missing, known = np.concatenate(torque), np.concatenate(columns)
    known = known / np.maximum(np.linalg.norm(known, axis=0), 1e-30)
    left = missing - known @ np.linalg.lstsq(known, missing, rcond=SEARCH.same_column)[0]
    parts = np.split(left**2, np.cumsum([part.size for part in torque])[:-1])
    return [np.pad(part, grid.window.size // 2) for part, grid in zip(parts, tight.grids, strict=True)]


def _hold_tightly(problem: Problem, plant: Plant) -> Problem:
    """Hold joints tightly to the same recordings, which are smoothed as far as reversals allow.

    That of the residual must not answer to the noise of the encoder, so that it answers an effect late and blurred, and
    a joint without the effect strays until it does; a stiff bristle even holds it against the observer. What two joints
    on the same motion differ by has little noise.
    """
    tracks = [
        replace(
            track,
            position=differentiate(track.position, track.dt, order=0),
            velocity=differentiate(track.position, track.dt),
        )
        for track in problem.tracks
    ]
    bandwidth = max(
        SEARCH.tighter * problem.observer.bandwidth, float(np.sqrt(SEARCH.stiffer * plant.sigma_0 / plant.inertia))
    )
    bandwidth = min(bandwidth, SEARCH.fastest_observer / max(track.dt for track in tracks))
    return build_problem(tracks, plant, replace(problem.observer, bandwidth=bandwidth))


def _measure_noise(spread: FloatArray, resting: FloatArray) -> float:
    """Noise of a row in which the joint slides [N·m]."""
    sliding = resting == 0.0
    return float(np.median(spread[sliding] if np.sum(sliding) >= SEARCH.fewest_sliding else spread))


def _centre(means: FloatArray) -> FloatArray:
    """Means from each sample to the next as means about each sample. Shape (n,)."""
    result: FloatArray = 0.5 * (means + np.concatenate([means[:1], means[:-1]]))
    return result


def _build_plain_joint(track: Track, grid: RowGrid, seen: Observation, plant: Plant) -> FloatArray:
    """What the parameters of a rigid joint with Stribeck friction add along its motion. Shape (n - m + 1, k)."""
    v, bristle = track.velocity, _centre(seen.bristle)
    samples = [np.gradient(v, track.dt), np.ones_like(v)]
    if track.rotary:
        samples += [np.cos(track.position), np.sin(track.position)]
    for sign, (coulomb, static, speed, _) in ((1.0, plant.forward), (-1.0, plant.reverse)):
        square = (v / speed) ** 2
        fall = np.exp(-square)
        dry = np.where(sign * bristle > 0.0, bristle, 0.0) / np.maximum(coulomb + (static - coulomb) * fall, 1e-9)
        samples += [dry, dry * fall, dry * fall * square, v * (sign * v > 0.0)]
    return np.column_stack([grid.average_everywhere(column) for column in samples])
