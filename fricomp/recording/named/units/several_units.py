"""One quantity that a log has in several units: `pos_deg` beside `pos_rad`."""

from collections.abc import Sequence

import numpy as np

from fricomp.recording.unit import UNITS
from fricomp.recording.validity import Samples

_ROUNDED = 2e-3
"""Part of the range by which two such columns may differ, since both were rounded when they were written."""


def are_one_quantity(columns: Sequence[tuple[Samples, str]]) -> bool:
    """Whether columns in different units say the same of each row.

    Args:
        columns: Numbers, shape (n_rows,), and the name of their unit, empty for that of SI.
    """
    units = [unit for _, unit in columns]
    if len(set(units)) < len(units) or any(unit and unit not in UNITS for unit in units):
        return False
    first, *others = [values * (UNITS[unit].factor if unit else 1.0) for values, unit in columns]
    if any(one.shape != first.shape for one in others):
        return False
    range_ = float(np.ptp(first[np.isfinite(first)])) if np.isfinite(first).any() else 0.0
    return range_ > 0.0 and all(float(np.nanmax(np.abs(one - first))) <= _ROUNDED * range_ for one in others)
