"""Fewer points for the screen, without losing a peak."""

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
    first, last = edges[:-1, None], edges[1:, None] - 1
    each = np.minimum(first + np.arange(int(np.max(np.diff(edges)))), last)  # a shorter stretch repeats its last
    ends = [each[np.arange(stretches), found] for found in (low[each].argmin(axis=1), high[each].argmax(axis=1))]
    rows = np.unique(np.concatenate([[0, x.size - 1], np.flatnonzero(np.isnan(y))[:limit], *ends]))
    return x[rows], y[rows]
