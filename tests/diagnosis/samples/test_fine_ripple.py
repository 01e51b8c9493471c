"""The spectrum over position that fine ripples are found in."""

import numpy as np
import pytest

from fricomp.diagnosis.samples.fine_ripple import compute_spectrum


@pytest.mark.parametrize("count", [2, 40, 97])
def test_each_order_has_the_energy_of_its_own_wave(count: int) -> None:
    rng = np.random.default_rng(5)
    position, residual = rng.uniform(-2.0, 2.0, 300), rng.standard_normal(300)
    orders = np.linspace(7.0, 6.5 + 0.5 * count, count, dtype=np.float64)
    waves = np.exp(1j * orders[:, None] * position)
    known = 2.0 * np.abs(waves @ residual) ** 2 / 300
    np.testing.assert_allclose(compute_spectrum(residual, position, orders), known, rtol=1e-9)
