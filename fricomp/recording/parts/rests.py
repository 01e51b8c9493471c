"""Long rests: they show nothing of sliding, and what drifts in them bends what is fitted."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.recording import Recording

_LONGEST = 15.0
"""Rest that is kept whole [s]; breakaway after some seconds of dwell is friction too."""
_KEPT = 2.0
"""Of a long rest, what is kept after one motion and before the next [s]."""
_STILL = 2e-4
"""Part of the travel within which a joint rests."""
_MOST = 0.95
"""Part of the time at rest above which the rest is what was recorded."""


def locate_rests(recording: Recording) -> list[tuple[int, int]]:
    """First row and row after the last of each stretch without motion, in order; short ones are among them."""
    position = np.asarray(recording.position)
    tolerance = max(_STILL * float(np.ptp(position)), 2.01 * measure_quantum(position))
    block = max(1, position.size // 4000)
    starts = np.arange(0, position.size, block)
    lows, highs = np.minimum.reduceat(position, starts), np.maximum.reduceat(position, starts)
    spans: list[tuple[int, int]] = []
    first, low, high = 0, lows[0], highs[0]
    for k in range(1, starts.size):
        low, high = min(low, lows[k]), max(high, highs[k])
        if high - low > tolerance:
            spans.append((int(starts[first]), int(starts[k])))
            first, low, high = k, lows[k], highs[k]
    spans.append((int(starts[first]), position.size))
    return spans


def find_rests(recording: Recording) -> NDArray[np.bool_]:
    """Rows inside of long rests, without what is kept at both ends. Shape (n_samples,)."""
    time = np.asarray(recording.time)
    inside = np.zeros(len(recording), dtype=bool)
    for a, b in locate_rests(recording):
        if time[b - 1] - time[a] > _LONGEST:
            # Where the recording begins or ends at rest there is no motion on that side.
            after, before = _KEPT if a > 0 else -1.0, _KEPT if b < time.size else -1.0
            inside |= (time > time[a] + after) & (time < time[b - 1] - before)
    return inside if inside.mean() <= _MOST else np.zeros(len(recording), dtype=bool)
