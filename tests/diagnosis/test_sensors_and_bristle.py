"""What the diagnosis finds out about a recording's sensors, and the bristle of its base model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.inputs.track import (
    FloatArray,
    Track,
    differentiate,
    measure_position_noise,
    measure_torque_noise,
)
from fricomp.diagnosis.joint.kernel import LANES, observe
from fricomp.diagnosis.joint.observer import Plant

DT = 1e-3


def swing(instants: FloatArray, step: float) -> FloatArray:
    """Two sines sampled at `instants` by an encoder with `step`."""
    position = 0.6 * np.sin(1.3 * instants) + 0.2 * np.sin(4.1 * instants)
    return np.asarray(np.round(position / step) * step)


@pytest.mark.parametrize("step", [6e-6, 2.4e-5])
@pytest.mark.parametrize("jitter", [1e-5, 4e-5])
def test_uneven_sampling_is_measured(step: float, jitter: float) -> None:
    rng = np.random.default_rng(4)
    time = np.arange(30_000, dtype=np.float64) * np.float64(DT)
    position = swing(time + np.float64(jitter) * rng.standard_normal(time.size), step)
    assert measure_position_noise(position, differentiate(position, DT)).jitter == pytest.approx(jitter, rel=0.25)


def test_even_sampling_shows_next_to_no_jitter_and_slow_sampling_none_at_all() -> None:
    time = np.arange(30_000, dtype=np.float64) * np.float64(DT)
    position = swing(time, 2.4e-5)
    assert measure_position_noise(position, differentiate(position, DT)).jitter < 6e-6
    slow = swing(np.arange(3_000, dtype=np.float64) * np.float64(0.05), 1e-7)
    assert measure_position_noise(slow, differentiate(slow, 0.05)).jitter == 0.0


@pytest.mark.parametrize(("freedom", "low", "high"), [(3.0, 2.0, 4.5), (1e6, 20.0, np.inf)])
def test_heavy_tails_are_told_from_normal_noise(freedom: float, low: float, high: float) -> None:
    noise = np.random.default_rng(5).standard_t(freedom, 60_000)
    noise *= 0.05 / (np.sqrt(freedom / (freedom - 2.0)))
    found = measure_torque_noise(2.0 * np.sin(np.arange(noise.size) * DT) + noise)
    assert low <= found.freedom <= high
    assert found.size == pytest.approx(0.05, rel=0.12)


def test_noise_that_is_drawn_has_the_size_it_was_measured_with() -> None:
    rng = np.random.default_rng(6)
    track = Track.build(
        DT, swing(np.arange(20_000, dtype=np.float64) * np.float64(DT), 1e-6), 0.1 * rng.standard_normal(20_000)
    )
    assert np.std(track.torque_noise.draw(50_000, rng)) == pytest.approx(0.1, rel=0.1)


def reversal_torque(plant: Plant, travel: float) -> FloatArray:
    """Bristle torque along a slow reversal: 2 `travel` forwards, then `travel` back. Shape (n,)."""
    there, back = np.linspace(0.0, 2.0 * travel, 4000), np.linspace(2.0 * travel, travel, 2000)
    position = np.concatenate([there, back])
    velocity = np.gradient(position, DT)
    settings, substeps = np.array([DT, 1e6, 2e3, 0.0, 0.0]), np.full(position.size, 10)
    lanes = tuple(range(LANES[1]))
    signals = (position, velocity, 0.0 * position, 0.0 * position)
    rows = np.zeros((4, len(lanes)), dtype=np.int64)
    plants, out = np.tile(plant.to_slots()[:, None], len(lanes)), np.empty((4, len(lanes), position.size))
    observe(tuple(one[None] for one in signals), rows, plants, settings, substeps, lanes, out)
    return np.asarray(out[3, 0])


def test_the_abrupt_share_follows_the_maxwell_slip_model() -> None:
    """Against the closed form: after a reversal every element yields once it has been bent back by twice its limit."""
    level, sigma_0, spread, travel = 1.0, 1e4, 2.0, 1e-3
    curve = (level, level, 0.1, 0.0)
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, sigma_0, sharpness=1.0, spread=spread)
    got = reversal_torque(plant, travel)[4000:]
    bent = np.linspace(0.0, travel, 2000)
    elements = [np.maximum(level - k * sigma_0 * bent, -level) for k in (spread, 1.0, 1.0 / spread)]
    assert got == pytest.approx(np.mean(elements, axis=0), abs=0.03 * level)


def test_without_the_abrupt_share_the_bristle_is_that_of_dahl() -> None:
    level, sigma_0, travel = 1.0, 1e4, 1e-3
    curve = (level, level, 0.1, 0.0)
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, sigma_0)
    bent = np.linspace(0.0, travel, 2000)
    got = reversal_torque(plant, travel)[4000:]
    assert got == pytest.approx(level * (2.0 * np.exp(-sigma_0 * bent / level) - 1.0), abs=0.03 * level)
    assert reversal_torque(replace(plant, spread=2.0), travel)[4000:] == pytest.approx(got)
