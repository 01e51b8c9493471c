"""What the sensors show against what is true."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from fricomp.errors import ParameterError
from fricomp.sim_bench.stand_in import SensorSettings
from fricomp.sim_bench.stand_in.sensor import SensorChain

PERIOD_NS = 1_000_000


def chain(settings: SensorSettings, seed: int = 0) -> SensorChain:
    made = SensorChain(settings, 1e-3, np.random.SeedSequence(seed))
    made.reset(0, 0.0, 0.0)
    return made


def sample_all(sensor: SensorChain, positions: np.ndarray, torque: float = 0.0) -> np.ndarray:
    """Position, velocity and torque readings, one row a sample."""
    rows = []
    for k, position in enumerate(positions):
        sensor.sample((k + 1) * PERIOD_NS, float(position), 0.0, torque)
        rows.append(sensor.newest[1:])
    return np.array(rows)


def test_encoder_has_2_to_the_18_counts_a_turn() -> None:
    rows = sample_all(chain(SensorSettings(delay=0.0)), np.linspace(0.0, 1e-3, 500))
    steps = np.diff(np.unique(rows[:, 0]))
    np.testing.assert_allclose(steps, 2.0 * pi / 2**18)


def test_velocity_estimate_follows_a_ramp_within_its_quantum() -> None:
    settings = SensorSettings(delay=0.0)
    rows = sample_all(chain(settings), 0.3 * np.arange(500) * 1e-3)
    settled = rows[100:, 1]
    assert settled.mean() == pytest.approx(0.3, rel=1e-3)
    assert np.abs(settled - 0.3).max() < settings.velocity_quantum(1e-3)


def test_torque_noise_offset_and_gain_are_as_set() -> None:
    settings = SensorSettings(torque_noise=0.01, torque_offset=0.02, torque_gain=1.1, torque_filter=0.0, delay=0.0)
    rows = sample_all(chain(settings), np.zeros(20_000), torque=2.0)
    assert rows[:, 2].mean() == pytest.approx(2.22, abs=4.0 * 0.01 / np.sqrt(20_000))
    assert rows[:, 2].std() == pytest.approx(0.01, rel=0.03)


def test_torque_filter_rises_with_its_time_constant() -> None:
    rows = sample_all(chain(SensorSettings(torque_filter=0.002, delay=0.0)), np.zeros(10), torque=1.0)
    np.testing.assert_allclose(rows[:, 2], 1.0 - np.exp(-np.arange(1, 11) / 2.0))


def test_readings_arrive_late_by_the_delay_and_carry_the_time_they_were_taken() -> None:
    sensor = chain(SensorSettings(encoder_counts=0, velocity_filter=0.0, delay=0.003))
    for k in range(1, 10):
        sensor.sample(k * PERIOD_NS, float(k), 0.0, 0.0)
    assert sensor.newest.time_ns == 6 * PERIOD_NS
    assert sensor.newest.position == 6.0


def test_ideal_sensors_show_the_truth_at_once() -> None:
    sensor = chain(SensorSettings.ideal())
    sensor.sample(PERIOD_NS, 0.1234567, -0.7654321, 3.1)
    assert sensor.newest == (PERIOD_NS, 0.1234567, -0.7654321, 3.1)


def test_noise_is_the_same_for_the_same_seed_and_starts_over_on_reset() -> None:
    settings, still = SensorSettings(torque_noise=0.1), np.zeros(50)
    first = chain(settings)
    rows = sample_all(first, still)
    np.testing.assert_array_equal(rows, sample_all(chain(settings), still))
    assert not np.array_equal(rows, sample_all(chain(settings, seed=1), still))
    first.reset(0, 0.0, 0.0)
    np.testing.assert_array_equal(rows, sample_all(first, still))


@pytest.mark.parametrize("wrong", [{"torque_noise": -0.1}, {"delay": float("nan")}, {"torque_offset": float("inf")}])
def test_impossible_settings_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        SensorSettings(**wrong)  # type: ignore[arg-type]
