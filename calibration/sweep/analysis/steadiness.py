"""Judges a plateau: did it settle, slide steadily, and stay inside the drive's torque?"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from fricomp.laws import FloatArray

__all__ = ["BATCHES", "CURES", "REASONS", "Mean", "Verdict", "find_transient", "judge_plateau", "mean_of"]

Verdict = Literal["steady", "unsettled", "stick_slip", "saturated", "short"]

REASONS: Final[dict[Verdict, str]] = {
    "stick_slip": "sticking and slipping",
    "unsettled": "not settled",
    "saturated": "torque at its limit",
    "short": "too short",
}
"""Why a plateau was rejected, in words."""
CURES: Final[dict[Verdict, str]] = {
    "stick_slip": "more damping (--bandwidth, or the gains of the drive's own loop) or higher --speeds",
    "unsettled": "lower --speeds, or better gains of the drive's own loop",
    "saturated": "lower --speeds, or a higher torque limit",
    "short": "a longer --dwell, lower --speeds, or more travel",
}
"""What helps against it."""

# Batches for the standard error of a mean of correlated samples.
BATCHES = 16
# A window that moves at less than this fraction of the speed has stuck; more spread than that is not steady.
STUCK = 0.3
SPREAD = 0.35
# A limit cycle shows in the torque, too: where that swings by this fraction of its mean, less spread is enough.
SWING, SPREAD_WITH_SWING = 0.1, 0.15
# Encoder counts that a window must hold, so that quantisation is not taken for sticking.
COUNTS = 12
SHORTEST_WINDOW = 0.01
# And so many times the jitter of the samples' times, which a busy computer makes.
JITTERS = 10.0
# Periods after which a sample counts as late.
LATE = 3.0
# Standard errors between the means of a transient and of the rest.
ANOTHER_MEAN = 3.0
# Fraction of the torque limit at which the drive may be saturated.
SATURATED = 0.98


@dataclass(frozen=True)
class Mean:
    """The mean of correlated samples.

    Attributes:
        value: The mean.
        deviation: Its standard error, from the means of batches.
    """

    value: float
    deviation: float


def mean_of(samples: FloatArray) -> Mean:
    """Mean and standard error of samples in order of time. Shape (n,)."""
    batches = np.array([batch.mean() for batch in np.array_split(samples, min(BATCHES, len(samples)))])
    spread = float(np.std(batches, ddof=1)) if len(batches) > 1 else 0.0
    return Mean(float(samples.mean()), spread / np.sqrt(len(batches)))


def find_transient(samples: FloatArray) -> int:
    """Number of samples at the start, half of them at most, that still belong to the way to the plateau.

    The rule of least standard error: what is cut off makes the mean of the rest most certain [white1997]. It is cut
    off only if its own mean is another one, so that nothing is taken from plain noise.
    """
    if len(samples) < BATCHES:
        return 0
    parts = np.array_split(samples, BATCHES)
    batches = np.array([part.mean() for part in parts])
    n_cut = int(np.argmin([np.var(batches[n:]) / (BATCHES - n) for n in range(BATCHES // 2 + 1)]))
    if n_cut == 0:
        return 0
    gap = abs(float(batches[:n_cut].mean() - batches[n_cut:].mean()))
    error = float(np.std(batches[n_cut:], ddof=1)) * np.sqrt(1.0 / n_cut + 1.0 / (BATCHES - n_cut))
    return sum(len(part) for part in parts[:n_cut]) if gap > ANOTHER_MEAN * error else 0


def judge_plateau(
    time: FloatArray, position: FloatArray, torque: FloatArray, velocity: float, *, quantum: float, torque_limit: float
) -> Verdict:
    """What the settled part of a plateau is worth.

    Args:
        time: [s]. Shape (n,).
        position: [rad] or [m]. Shape (n,).
        torque: Measured [N·m] or [N]. Shape (n,).
        velocity: What was asked for [rad/s] or [m/s].
        quantum: Step of the encoder [rad] or [m].
        torque_limit: Of the drive [N·m] or [N].
    """
    if len(time) < 4 * BATCHES:
        return "short"
    if np.mean(np.abs(torque) >= SATURATED * torque_limit) > 0.01:
        return "saturated"
    speeds = _average_windows(time, position, velocity, quantum)
    if len(speeds) < 3:
        return "short"
    swings = np.std(torque) > SWING * abs(float(np.mean(torque)))
    if np.min(speeds) < STUCK or np.std(speeds) > (SPREAD_WITH_SWING if swings else SPREAD):
        return "stick_slip"
    if abs(float(np.mean(speeds)) - 1.0) > 0.05:
        return "unsettled"
    return "steady"


def _average_windows(time: FloatArray, position: FloatArray, velocity: float, quantum: float) -> FloatArray:
    """Mean speed of windows as a fraction of the speed asked for. Shape (n_windows,)."""
    gaps = np.diff(time)
    usual = float(np.median(gaps))
    jitter = float(np.quantile(gaps, 0.95)) - usual
    window = max(SHORTEST_WINDOW, COUNTS * quantum / abs(velocity), JITTERS * jitter)
    edges = np.searchsorted(time, np.arange(time[0], time[-1], window))
    edges = np.unique(np.minimum(edges, len(time) - 1))
    speeds = np.diff(position[edges]) / np.diff(time[edges]) / velocity
    # A sample that came late may be as old as it is late: windows with one in them tell nothing.
    late = np.concatenate([[0], np.cumsum(gaps > LATE * usual), [0]])
    late[-1] = late[-2]
    prompt = late[edges[1:] + 1] == late[np.maximum(edges[:-1] - 1, 0)]
    return np.asarray(speeds[prompt] if 2 * prompt.sum() >= len(speeds) else speeds)
