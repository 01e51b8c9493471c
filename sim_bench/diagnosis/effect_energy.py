"""Energy of what effects add and a plain joint cannot take up: where they show however well that joint is fitted."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from .observer import Observation, Plant
from .preparation import Prepared
from .problem import Problem, observer_for
from .rows import RowGrid
from .structure import Structure
from .track import FloatArray, Track

__all__ = ["effect_energy"]

_SAME = 1e-9  # part of a column, below which it is one of the others
_FEWEST = 50  # rows in which the joint slides that tell the noise
_TIGHTER = 3.0  # than the observer of the residual


def effect_energy(
    prepared: Prepared, structure: Structure, theta: FloatArray, names: Collection[str]
) -> list[FloatArray]:
    """Energy of the effects' torque that a refit of a rigid joint with Stribeck friction leaves, over the noise.

    It is asked of a window about every sample: an impact or a reversal is shorter than the way from row to row. The
    noise is that of a typical row, since some dozens of nulls know the energy of a single one to a quarter only. Where
    the bristle holds, an encoder step stretches it by a torque that says nothing about effects: the noise counts as at
    least that, as far as the joint rests in the window.

    Args:
        prepared: Base model and recordings.
        structure: Base and effects.
        theta: Their parameters.
        names: The effects that are asked for.

    Returns:
        Energy of each sample, by recording; 0 where no window fits. Shapes (n_samples,).
    """
    problem, plant = prepared.problem, structure.plant(theta)
    motion = structure.observe(problem, theta)
    tight = _held_to(motion, problem, plant)
    complete, without = structure.with_and_without(tight, theta, names)
    torque, columns = [], []
    for i, (track, grid, seen) in enumerate(zip(tight.tracks, tight.grids, motion, strict=True)):
        rests = (np.abs(seen.velocity) < problem.observer.rest_speed).astype(float)
        level = _noise(prepared.nulls.weights.spread[i], problem.grids[i].of(rests))
        step = plant.sigma_0 * track.resolution / np.sqrt(12.0)
        noise = np.hypot(level, grid.everywhere(rests) * step)
        added = _centred(without[i].missing - complete[i].missing)
        torque.append(grid.everywhere(added) / noise)
        columns.append(_plain_joint(track, grid, without[i], plant) / noise[:, None])
    missing, known = np.concatenate(torque), np.concatenate(columns)
    known = known / np.maximum(np.linalg.norm(known, axis=0), 1e-30)
    left = missing - known @ np.linalg.lstsq(known, missing, rcond=_SAME)[0]
    parts = np.split(left**2, np.cumsum([part.size for part in torque])[:-1])
    return [np.pad(part, grid.window.size // 2) for part, grid in zip(parts, tight.grids, strict=True)]


def _held_to(motion: list[Observation], problem: Problem, plant: Plant) -> Problem:
    """The same recordings moved as in `motion`, and held to it more tightly.

    The observer answers an effect late and blurred, and the joint without the effect strays until it does. The
    simulated motion has little noise, so that it may be followed closely.
    """
    tracks = [
        replace(track, position=one.position, velocity=one.velocity)
        for track, one in zip(problem.tracks, motion, strict=True)
    ]
    return observer_for(tracks, plant, replace(problem.observer, bandwidth=_TIGHTER * problem.observer.bandwidth))


def _noise(spread: FloatArray, resting: FloatArray) -> float:
    """Noise of a row in which the joint slides [N·m]."""
    sliding = resting == 0.0
    return float(np.median(spread[sliding] if np.sum(sliding) >= _FEWEST else spread))


def _centred(means: FloatArray) -> FloatArray:
    """Means from each sample to the next as means about each sample. Shape (n,)."""
    result: FloatArray = 0.5 * (means + np.concatenate([means[:1], means[:-1]]))
    return result


def _plain_joint(track: Track, grid: RowGrid, seen: Observation, plant: Plant) -> FloatArray:
    """What the parameters of a rigid joint with Stribeck friction add along its motion. Shape (n - m + 1, k)."""
    v, bristle = track.velocity, _centred(seen.bristle)
    samples = [np.gradient(v, track.dt), np.ones_like(v)]
    if track.rotary:
        samples += [np.cos(track.position), np.sin(track.position)]
    for sign, (coulomb, static, speed, _) in ((1.0, plant.forward), (-1.0, plant.reverse)):
        square = (v / speed) ** 2
        fall = np.exp(-square)
        dry = np.where(sign * bristle > 0.0, bristle, 0.0) / np.maximum(coulomb + (static - coulomb) * fall, 1e-9)
        samples += [dry, dry * fall, dry * fall * square, v * (sign * v > 0.0)]
    return np.column_stack([grid.everywhere(column) for column in samples])
