"""Energy of what effects add and a plain joint cannot take up: where they show however well that joint is fitted."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from .observer import Observation, Plant
from .preparation import Prepared
from .rows import RowGrid
from .structure import Structure
from .track import FloatArray, Track

__all__ = ["effect_energy"]

_SAME = 1e-9  # part of a column, below which it is one of the others


def effect_energy(
    prepared: Prepared, structure: Structure, theta: FloatArray, names: Collection[str]
) -> list[FloatArray]:
    """Energy of the effects' torque that a refit of a rigid joint with Stribeck friction leaves, over the noise.

    Where the bristle holds, an encoder step stretches it by a torque that says nothing about them: the noise of a row
    counts as at least that, as far as the joint rests in it.

    Args:
        prepared: Base model and recordings.
        structure: Base and effects.
        theta: Their parameters.
        names: The effects that are asked for.

    Returns:
        Energy of each row, by recording. Shapes (n_rows,).
    """
    problem, plant = prepared.problem, structure.plant(theta)
    complete, without = structure.with_and_without(problem, theta, names)
    torque = [b - a for a, b in zip(problem.rows(complete), problem.rows(without), strict=True)]
    noise, columns = [], []
    recorded = zip(problem.tracks, problem.grids, complete, prepared.nulls.weights.spread, strict=True)
    for track, grid, seen, spread in recorded:
        resting = grid.of((np.abs(seen.velocity) < problem.observer.rest_speed).astype(float))
        step = plant.sigma_0 * track.resolution / np.sqrt(12.0)
        noise.append(np.hypot(spread, resting * step))
        columns.append(_plain_joint(track, grid, seen, plant))
    loudness = np.concatenate(noise)
    missing, known = np.concatenate(torque) / loudness, np.concatenate(columns) / loudness[:, None]
    known = known / np.maximum(np.linalg.norm(known, axis=0), 1e-30)
    left = missing - known @ np.linalg.lstsq(known, missing, rcond=_SAME)[0]
    return np.split(left**2, np.cumsum([part.size for part in torque])[:-1])


def _plain_joint(track: Track, grid: RowGrid, seen: Observation, plant: Plant) -> FloatArray:
    """Rows of what the parameters of a rigid joint with Stribeck friction add along its motion. Shape (n_rows, k)."""
    v = seen.velocity
    samples = [np.gradient(v, track.dt), np.ones_like(v)]
    if track.rotary:
        samples += [np.cos(seen.position), np.sin(seen.position)]
    for sign, curve in ((1.0, plant.forward), (-1.0, plant.reverse)):
        moving = sign * v > 0.0
        square = (v / curve[2]) ** 2
        falling = sign * moving * np.exp(-square)
        samples += [sign * moving, falling, falling * square, v * moving]
    return np.column_stack([grid.of(column) for column in samples])
