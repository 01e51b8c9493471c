"""A delay is undone by reading later samples."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.inputs.delay import apply_lags, shift, undo_lags


@pytest.mark.parametrize("samples", [0.0, 0.25, 3.0, 2.5, -1.75, -4.0, 200.0, -200.0])
def test_a_shift_reads_later_samples_and_holds_the_ends(samples: float) -> None:
    values = np.random.default_rng(0).standard_normal(50)
    index = np.arange(50.0)
    np.testing.assert_allclose(shift(values, samples), np.interp(index + samples, index, values), atol=1e-12)


@pytest.mark.parametrize("lags", [(4e-3,), (2e-3, 2e-3), (3e-4,), (1e-6,)])
def test_a_ramp_comes_late_by_its_time_constants_whatever_the_sample_time(lags: tuple[float, ...]) -> None:
    dt = 1e-3
    ramp = np.arange(400, dtype=np.float64) * dt
    late = apply_lags(ramp, lags, dt)
    np.testing.assert_allclose(ramp[200:] - late[200:], sum(lags), atol=1e-12)
    np.testing.assert_allclose(undo_lags(late, lags, dt)[100:-1], ramp[100:-1], atol=1e-12)


def test_a_slow_wave_comes_through_a_low_pass_as_its_transfer_function_says() -> None:
    dt, lag, rate = 1e-3, 4e-3, 2.0 * np.pi * 3.0
    time = np.arange(3000, dtype=np.float64) * dt
    passed = 1.0 / (1.0 + 1j * rate * lag)
    wanted = np.imag(passed * np.exp(1j * rate * time))
    np.testing.assert_allclose(apply_lags(np.sin(rate * time), (lag,), dt)[500:], wanted[500:], atol=4e-5)


@pytest.mark.parametrize("lag", [2e-3, 8e-3, 3e-2])
def test_a_low_pass_of_few_samples_is_as_late_and_as_spread_as_one_of_many(lag: float) -> None:
    coarse, fine = 2e-3, 2e-5
    knots = np.cumsum(np.random.default_rng(4).standard_normal(400))
    straight = np.interp(np.arange(0.0, 399.0 * coarse, fine), np.arange(400) * coarse, knots)
    many, few = apply_lags(straight, (lag,), fine)[::100], apply_lags(knots, (lag,), coarse)
    np.testing.assert_allclose(few[: many.size], many, atol=1e-9)
