"""How large values are on the whole: the root of the mean of their squares."""

import numpy as np
from numpy.typing import ArrayLike


def compute_rms(values: ArrayLike) -> float:
    """Root of the mean square of all values, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))
