"""Charts over time show what was recorded, and nothing between."""

from __future__ import annotations

import numpy as np

from fricomp.diagnosis.report.over_time import _break_at_gaps


def test_no_line_is_drawn_over_a_rest() -> None:
    """Over 3 s in which a joint of an arm stood still, its residual was a straight line from stroke to stroke."""
    time = np.concatenate([np.arange(0.0, 1.0, 0.01), np.arange(4.0, 5.0, 0.01)])
    broken, rows = _break_at_gaps(time, np.ones_like(time))
    assert np.flatnonzero(np.isnan(rows)).tolist() == [100]
    assert np.all(np.diff(broken) >= 0.0)
    assert np.all(np.isfinite(broken))
    assert all(one.size == 3 for one in _break_at_gaps(np.arange(3.0), np.ones(3)))
