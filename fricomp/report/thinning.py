"""Fewer points for the screen, without losing a peak."""

from itertools import pairwise

import numpy as np

from fricomp.report.chart import Values


def thin(x: Values, y: Values, limit: int = 4000) -> tuple[Values, Values]:
    """The curve in at most about `limit` points: the lowest and the highest of each stretch.

    Args:
        x: Shape (n,).
        y: Shape (n,); gaps (NaN) stay.
        limit: Points to keep.
    """
    if x.size <= limit:
        return x, y
    stretches = limit // 2
    edges = np.linspace(0, x.size, stretches + 1).astype(int)
    low, high = np.where(np.isnan(y), np.inf, y), np.where(np.isnan(y), -np.inf, y)
    kept = {0, x.size - 1, *np.flatnonzero(np.isnan(y)).tolist()[:limit]}
    for start, stop in pairwise(edges.tolist()):
        kept |= {start + int(np.argmin(low[start:stop])), start + int(np.argmax(high[start:stop]))}
    rows = np.array(sorted(kept))
    return x[rows], y[rows]
