"""A delay is undone by reading later samples."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.sim_bench.diagnosis.delay import shifted


@pytest.mark.parametrize("samples", [0.0, 0.25, 3.0, 2.5, -1.75, -4.0, 200.0, -200.0])
def test_a_shift_reads_later_samples_and_holds_the_ends(samples: float) -> None:
    values = np.random.default_rng(0).standard_normal(50)
    index = np.arange(50.0)
    np.testing.assert_allclose(shifted(values, samples), np.interp(index + samples, index, values), atol=1e-12)
