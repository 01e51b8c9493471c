"""Stretches of time in which a torque from outside acted: they stand out, are few, and the state does not explain them.

The base model follows a push as far as it can, and errs elsewhere for it. So the windows are left out of a linearised
refit of the base, found again in what that leaves, and so on until they stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_dilation, label, sum_labels, uniform_filter1d
from scipy.spatial import cKDTree

from ..inputs.track import FloatArray
from ..joint.problem import Problem
from ..joint.solver import Box, Fit, raise_diagonal
from .context import Context
from .settings import EFFECT

_Mask = NDArray[np.bool_]


class _Window(NamedTuple):
    recording: int
    start: float
    end: float


def shape_push(time: FloatArray, start: float, end: float, roundness: float = 1.0) -> FloatArray:
    """A push between `start` and `end` [s]: half a sine wave to the power of `roundness`. Shape (n,)."""
    phase = np.clip((time - start) / max(end - start, 1e-6), 0.0, 1.0)
    result: FloatArray = np.maximum(np.sin(np.pi * phase), 0.0) ** roundness
    return result


def find_time_windows(problem: Problem, contexts: Sequence[Context], fit: Fit, box: Box) -> tuple[float, ...]:
    """Find the windows: recording, start and end [s] of each, one after the other; empty where time alone does not
    explain them."""
    inside = np.zeros(fit.residual.size, dtype=bool)
    left = fit.residual
    for _ in range(EFFECT.window_rounds):
        found = _find_standing_out(problem, left)
        if np.array_equal(found, inside) or not 0.0 < found.mean() < EFFECT.most_inside:
            inside = found
            break
        inside, left = found, _refit_without(found, fit, box)
    if not inside.any() or inside.mean() > EFFECT.longest_windows or not _is_compact(inside, left):
        return ()
    windows = [_fit_window(problem, window, left) for window in _find_intervals(problem, inside, left)]
    energy = [_compute_explained(problem, window, left) for window in windows]
    windows = [window for window, one in zip(windows, energy, strict=True) if one > EFFECT.faint_window * max(energy)]
    if len(windows) > EFFECT.most_windows or not _is_independent_of_state(problem, contexts, inside, left):
        return ()
    return tuple(value for window in windows for value in window)


def _find_standing_out(problem: Problem, left: FloatArray) -> _Mask:
    """Rows in a stretch whose running mean stands out."""
    masks = []
    for part in _split_by_recording(problem, left):
        mean = np.abs(uniform_filter1d(part, EFFECT.window_mean)) * np.sqrt(EFFECT.window_mean)
        level = max(float(np.median(mean)) / 0.6745, 1.0)  # the median of |z| for a standard normal z
        edge, core = mean > EFFECT.window_edge * level, mean > EFFECT.window_core * level
        stretch, _ = label(edge)
        kept = np.isin(stretch, np.unique(stretch[core])) & edge
        gap = EFFECT.window_gap
        masks.append(binary_closing(np.pad(kept, gap), np.ones(gap))[gap:-gap])
    return np.concatenate(masks)


def _refit_without(inside: _Mask, fit: Fit, box: Box) -> FloatArray:
    """The residual once the base is refitted, linearly, to the rows that are not `inside`. Shape (m,)."""
    A = fit.jacobian * box.scale
    out = ~binary_dilation(inside, np.ones(2 * EFFECT.window_mean + 1))
    H = A[out].T @ A[out] + raise_diagonal(box.scaled_precision, 1e-6)
    result: FloatArray = fit.residual - A @ np.linalg.solve(H, A[out].T @ fit.residual[out])
    return result


def _is_compact(inside: _Mask, left: FloatArray) -> bool:
    out = ~binary_dilation(inside, np.ones(EFFECT.window_mean))
    if out.sum() < EFFECT.least_outside * inside.size:
        return False
    outside = max(float(np.mean(left[out] ** 2)) - 1.0, 0.0)
    within = float(np.mean(left[inside] ** 2)) - 1.0
    return within > EFFECT.window_energy and outside < max(EFFECT.quiet_outside, within / EFFECT.window_contrast)


def _is_independent_of_state(problem: Problem, contexts: Sequence[Context], inside: _Mask, left: FloatArray) -> bool:
    """Tell whether the joint was in the same states outside of the windows as well, where nothing stood out, or in one
    that points the other way as a whole: of two like strokes a push bends the base into both.

    Most rows of a window may lie at its quiet edges. So where it is loud, position, speed and acceleration must each
    occur outside as well: what is loud at one end of the range, where the joint was only then, may be a stop.
    """
    states = _collect_states(problem, contexts)
    stretch, count = label(inside)
    pulls = np.append(0.0, np.sign(sum_labels(left, stretch, np.arange(1, count + 1))))[stretch]
    if float(np.mean(_find_near(states, pulls))) <= EFFECT.visited_share and not _are_pairs_near(states, pulls):
        return False
    energy = left[inside] ** 2
    least = EFFECT.visited_energy * float(energy.sum())
    return all(float(energy @ _find_near(state[:, None], pulls)) > least for state in states.T)


def _are_pairs_near(states: FloatArray, pulls: FloatArray) -> bool:
    """Whether nearly all rows inside have some nearby that are outside, or pull the other way, by any two of position,
    speed and acceleration, where the direction alone stands for the speed at a position.

    A motion of several sines comes to no state of three numbers twice, and a law of the joint depends on two of them.
    """
    position, velocity, acceleration = states.T
    pairs = (position, np.sign(velocity)), (velocity, acceleration), (position, acceleration)
    return all(float(np.mean(_find_near(np.stack(pair, axis=1), pulls))) > EFFECT.visited_pairs for pair in pairs)


def _collect_states(problem: Problem, contexts: Sequence[Context]) -> FloatArray:
    """Collect position, speed and acceleration of each row, in their ranges. The last two are compressed where they are
    large.

    Shape (m, 3).
    """
    states = []
    for name, power in (("position", 1.0), ("velocity", 0.5), ("acceleration", 0.5)):
        rows = [getattr(c, name)[grid.centres] for c, grid in zip(contexts, problem.grids, strict=True)]
        values = np.concatenate(rows)
        values = np.sign(values) * np.abs(values) ** power
        # The reach without the outer hundredths, which single samples make.
        states.append(values / max(float(np.quantile(values, 0.99) - np.quantile(values, 0.01)), 1e-12))
    return np.stack(states, axis=1)


def _find_near(points: FloatArray, pulls: FloatArray) -> _Mask:
    """Which points inside have one nearby that is outside, where `pulls` is zero, or pulls the other way. Shape
    (n_inside,)."""
    near = np.zeros(pulls.size, dtype=bool)
    for way in (-1.0, 1.0):
        own, others = points[pulls == way], points[pulls != way]
        if own.size and others.size:
            near[pulls == way] = cKDTree(others).query(own)[0] < EFFECT.near_state
    result: _Mask = near[pulls != 0.0]
    return result


def _find_intervals(problem: Problem, inside: _Mask, left: FloatArray) -> list[_Window]:
    """The stretches, those of one direction with a short break between them joined."""
    windows: list[_Window] = []
    parts = zip(_split_by_recording(problem, inside), _split_by_recording(problem, left), strict=True)
    for which, (part, values) in enumerate(parts):
        time = problem.grids[which].centres * problem.tracks[which].dt
        stretch, count = label(part)
        last = 0.0
        for i in range(1, count + 1):
            rows = np.flatnonzero(stretch == i)
            sign, start, end = np.sign(values[rows].sum()), float(time[rows[0]]), float(time[rows[-1]])
            near = windows and windows[-1].recording == which and start - windows[-1].end < EFFECT.window_break
            if near and sign == last:
                start = windows.pop().start
            windows.append(_Window(which, start, end))
            last = sign
    return windows


def _fit_window(problem: Problem, window: _Window, left: FloatArray) -> _Window:
    """Move start and end of a window until a push between them explains most of what the base leaves."""
    best, most = window, _compute_explained(problem, window, left)
    for step in EFFECT.window_steps:
        moved = True
        while moved:
            moved = False
            for start, end in ((-step, 0.0), (step, 0.0), (0.0, -step), (0.0, step)):
                trial = _Window(best.recording, best.start + start, best.end + end)
                if trial.end - trial.start < 2.0 * step or trial.start < 0.0:
                    continue
                energy = _compute_explained(problem, trial, left)
                if energy > most * (1.0 + 1e-6):
                    best, most, moved = trial, energy, True
    return best


def _compute_explained(problem: Problem, window: _Window, left: FloatArray) -> float:
    assert problem.weights is not None
    rows = [mean.copy() for mean in problem.weights.mean]
    track, grid = problem.tracks[window.recording], problem.grids[window.recording]
    rows[window.recording] += shape_push(grid.centres * track.dt, window.start, window.end)
    column = problem.weights.apply(rows)
    size = float(column @ column)
    return float(column @ left) ** 2 / size if size > 0.0 else 0.0


def _split_by_recording(problem: Problem, values: np.ndarray) -> list[np.ndarray]:
    return np.split(values, np.cumsum([grid.centres.size for grid in problem.grids])[:-1])
