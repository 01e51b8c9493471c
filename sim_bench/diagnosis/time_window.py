"""Stretches of time in which the residual keeps one sign: where a torque from outside may have acted."""

from __future__ import annotations

import numpy as np

from .problem import Problem
from .track import FloatArray

__all__ = ["time_windows"]

_LENGTHS = (0.1, 0.2, 0.4, 0.8, 1.6, 3.0, 6.0)  # [s]
_COUNT = 3


def time_windows(problem: Problem, residual: FloatArray) -> tuple[float, ...]:
    """The strongest windows as recording, start and end [s], one after the other."""
    found: list[tuple[float, float, float, float]] = []
    at = 0
    for which, (track, grid) in enumerate(zip(problem.tracks, problem.grids, strict=True)):
        y = residual[at : at + grid.centres.size]
        at += grid.centres.size
        time = grid.centres * track.dt
        total = np.concatenate([[0.0], np.cumsum(y)])
        for length in _LENGTHS:
            rows = max(2, round(length / (time[1] - time[0])))
            if rows >= y.size // 2:
                continue
            score = np.abs(total[rows:] - total[:-rows]) / np.sqrt(rows)
            best = int(np.argmax(score))
            found.append(
                (float(score[best]), float(which), float(time[best]), float(time[min(best + rows, y.size - 1)]))
            )
    found.sort(reverse=True)
    return tuple(value for _, which, start, end in found[:_COUNT] for value in (which, start, end))
