"""The static torque, measured: the torque at which a joint at rest gives way under a slow ramp."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

__all__ = ["Breakaway", "BreakawayRamp", "half_differences_at_rest", "measure_breakaway"]

# Displacement that counts as motion: this many encoder counts.
COUNTS = 12
# Samples of torque noise are averaged over this long before the ramp is searched [s].
SMOOTHING = 0.01
# Fewest samples of a ramp that are worth fitting.
SHORTEST_FIT = 24


@dataclass(frozen=True)
class BreakawayRamp:
    """How the torque is ramped: the reference creeps, the loop's stiffness turns that into torque.

    Attributes:
        position: Where [rad] or [m].
        direction: +1 or -1.
        creep: Speed of the reference [rad/s] or [m/s].
        number: Of the ramp, from 0; -1 for one that stands alone.
    """

    position: float
    direction: int
    creep: float
    number: int = -1


@dataclass(frozen=True)
class Breakaway:
    """One breakaway.

    Attributes:
        position: Where [rad] or [m].
        direction: +1 or -1.
        torque: Friction at which the joint gave way, positive [N·m] or [N].
        time: When [s].
        number: Of the ramp.
    """

    position: float
    direction: int
    torque: float
    time: float
    number: int = -1


def half_differences_at_rest(found: Sequence[Breakaway]) -> tuple[Breakaway, ...]:
    """Breakaways less what pulls in the same direction whichever way the joint gives way: gravity without a model.

    The ramps numbered 2k and 2k+1 go both ways at the same place; the mean of the two torques, each positive in its
    direction, is the mean friction of both. A place at which one of them is missing says nothing.
    """
    torque = {one.number: one.torque for one in found}
    return tuple(
        replace(one, torque=0.5 * (one.torque + torque[one.number ^ 1])) for one in found if one.number ^ 1 in torque
    )


def measure_breakaway(samples: Recording, direction: int, *, offset: float, quantum: float) -> Breakaway | None:
    """Where the ramp of torque ends: tau = a + r min(t, t_b), fitted up to a little motion; None if it never moved.

    Where the loop catches the joint, a level of creeping follows the ramp; where it gives way at once, the ramp just
    ends. Neither end is sharper than the encoder: before its first count the joint slides unseen under a torque that
    still rises (2 % too much on the default joint), afterwards it creeps from count to count (0.4 % too little).
    """
    torque = samples.torque - offset - (0.0 if samples.load_torque is None else samples.load_torque)
    torque = direction * torque
    moved = direction * (samples.position - samples.position[0])
    gone = np.flatnonzero(moved > COUNTS * max(quantum, 1e-7))
    if not len(gone):
        return None
    stop = int(gone[0]) + 1
    start = _find_past_half(samples.time[:stop], torque[:stop])
    if stop - start < SHORTEST_FIT:
        return None
    level, at = _fit_bent_line(samples.time[start:stop], torque[start:stop])
    return Breakaway(float(samples.position[0]), direction, level, at)


def _find_past_half(time: FloatArray, torque: FloatArray) -> int:
    """Index from which the torque stays past half of its rise: the last part of the ramp."""
    width = max(1, round(SMOOTHING / float(np.median(np.diff(time)))))
    smooth = np.convolve(torque, np.ones(width) / width, mode="same") if len(torque) > 2 * width else torque
    half = 0.5 * (float(smooth[: len(smooth) // 4 + 1].min()) + float(smooth.max()))
    below = np.flatnonzero(smooth[: -width or None] < half)
    return int(below[-1]) + 1 if len(below) else 0


def _fit_bent_line(time: FloatArray, torque: FloatArray) -> tuple[float, float]:
    """Level and time of the bend of the best tau = a + r min(t, t_b)."""
    best, level, bend = np.inf, float(torque[-1]), float(time[-1])
    for at in np.linspace(time[0], time[-1], 80)[4:]:
        basis = np.column_stack([np.ones_like(time), np.minimum(time, at) - at])
        coefficients, *_ = np.linalg.lstsq(basis, torque, rcond=None)
        error = float(np.sum((torque - basis @ coefficients) ** 2))
        if error < best:
            best, level, bend = error, float(coefficients[0]), float(at)
    return level, bend
