"""Which way friction acts where a joint stands still between two strokes: from the way of one to that of the other.

A joint that sticks has no velocity, and the sign of what smoothing leaves of it is chance: it changes every few samples
for as long as the joint stands still. Its friction goes from one level to the other meanwhile, by nobody knows which
curve; a straight line in time errs least.

A joint that turns round without sticking is within a distance d of where it turns for a time that grows with √d. What
it is there for beyond that, it stands still.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

_CHANCE = 4.0
"""Standard deviations by which the noise of a position moves it, at most."""

_THIRD_DIFFERENCE = float(np.sqrt(20.0))
"""Standard deviation of the third differences of a noise that is each sample's own, over its own."""

_NORMAL = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""

_NEAR, _FAR = 1.5, 5.5
"""Steps from where a joint turns within which it is for a time, and for about twice that time: of four times as far,
whole steps from anywhere within one."""

_SURE = 0.5
"""Part of the former time from which standing still is no matter of where within a step the joint turned."""

_ROUNDING, _SMALLER = 1e-9, 5
"""Part of the range below which a step is the arithmetic's, and how many smaller ones are no step of the encoder's."""


def find_step(position: FloatArray) -> float:
    """Step of an encoder [rad] or [m]; next to none where positions were not rounded."""
    steps = np.abs(np.diff(position))
    steps = np.sort(steps[steps > _ROUNDING * max(float(np.ptp(position)), 1e-300)])
    return float(steps[min(_SMALLER, steps.size - 1)]) if steps.size else 0.0


def find_rests(position: FloatArray) -> FloatArray:
    """Direction of friction, -1 to 1, about where a joint stands still between two strokes; elsewhere it is no number.

    Args:
        position: As it was recorded [rad] or [m]. Shape (n,).

    Returns:
        Shape (n,).
    """
    step = max(find_step(position), _measure_noise(position))
    turns = _find_turns(position, _FAR * step)
    ends, rests = [0, *turns.tolist(), len(position) - 1], np.full(len(position), np.nan)
    for first, turn, last in zip(ends, ends[1:], ends[2:], strict=False):
        way = np.sign(position[turn] - position[first])
        back = way * (position[turn] - position[first : last + 1])
        (begin, end), (before, after) = (_find_ends(back <= each * step) for each in (_NEAR, _FAR))
        still, moved = 2 * begin - before, 2 * end - after
        if moved - still > _SURE * (end - begin):
            rests[first + before : first + after + 1] = way * np.interp(
                np.arange(before, after + 1), [still, moved], [1.0, -1.0]
            )
    return rests


def _find_ends(near: NDArray[np.bool_]) -> tuple[int, int]:
    """First and last sample of those that are."""
    at = np.flatnonzero(near)
    return int(at[0]), int(at[-1])


def _measure_noise(position: FloatArray) -> float:
    """How far noise moves a position that has some in each sample, at most."""
    if len(position) < 4:
        return 0.0
    return _CHANCE * _NORMAL * float(np.median(np.abs(np.diff(position, 3)))) / _THIRD_DIFFERENCE


def _find_turns(position: FloatArray, back: float) -> NDArray[np.intp]:
    """Samples at which a path is farthest before it goes back by more than this. Shape (n_turns,)."""
    turns: list[int] = []
    way, high, low = 0.0, 0, 0
    path = position.tolist()
    for k, here in enumerate(path):
        if here > path[high]:
            high = k
        if here < path[low]:
            low = k
        if way >= 0.0 and path[high] - here > back:
            if way:
                turns.append(high)
            way, low = -1.0, k
        elif way <= 0.0 and here - path[low] > back:
            if way:
                turns.append(low)
            way, high = 1.0, k
    return np.array(turns, dtype=np.intp)
