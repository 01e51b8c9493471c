"""A derivative by a local cubic: scipy's, for any length of signal."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from fricomp.diagnosis.inputs.signal import differentiate


@pytest.mark.parametrize("size", [8, 22, 23, 400])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_derivatives_are_those_of_scipys_filter_to_both_ends(size: int, order: int) -> None:
    values = np.sin(np.linspace(0.0, 5.0, size)) + 0.01 * np.random.default_rng(size).standard_normal(size)
    window = min(21, size - 1 + size % 2)
    wanted = savgol_filter(values, window, 3, deriv=order, delta=1e-3)
    found = differentiate(values, 1e-3, 0.021, order)
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-9 * float(np.max(np.abs(wanted))))
