"""Fits that leave out a block are those of the samples that it leaves."""

import numpy as np
import pytest

from fricomp.diagnosis.inputs.left_out import fit_without_blocks


@pytest.mark.parametrize("gap", [(0, 0), (7, 6), (400, 400)])
@pytest.mark.parametrize("size", [1000, 37])
def test_each_block_is_left_out_with_its_gaps(gap: tuple[int, int], size: int) -> None:
    rng = np.random.default_rng(3)
    table, target = rng.standard_normal((size, 4)), rng.standard_normal(size)
    blocks = list(fit_without_blocks(table, target, 5, rcond=1e-9, gap=gap))
    np.testing.assert_array_equal(np.concatenate([part for part, _ in blocks]), np.arange(size))
    for part, weights in blocks:
        index = np.arange(size)
        kept = (index < part[0] - gap[0]) | (index > part[-1] + gap[1])
        known = np.linalg.lstsq(table[kept], target[kept], rcond=1e-9)[0] if kept.any() else np.zeros(4)
        np.testing.assert_allclose(weights, known, atol=1e-12)


def test_columns_that_are_one_share_their_weight() -> None:
    column = np.linspace(0.0, 1.0, 60)
    for _, weights in fit_without_blocks(np.stack([column, column], axis=1), column, 4, rcond=1e-6):
        np.testing.assert_allclose(weights, 0.5)
