"""What effects are computed from carries no sensor noise."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording
from fricomp.recording.metadata import TorqueKind
from fricomp.sim_bench.diagnosis.context import without_noise
from fricomp.sim_bench.diagnosis.generic import time_since_reversal
from fricomp.sim_bench.diagnosis.loading import build_tracks
from fricomp.sim_bench.diagnosis.track import Track, torque_noise, without_spikes


def test_a_recorded_load_loses_its_noise_and_keeps_its_shape() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(20_000) * 1e-3
    position = 0.8 * np.sin(time)
    acceleration = -position
    load = 5.0 * np.sin(position + 0.3) + 0.2 * acceleration
    track = Track.build(1e-3, position, load)
    noise = 0.05 * rng.standard_normal(time.size)
    clean = without_noise(load + noise, position, acceleration, track)
    assert np.std(clean - load) < 0.05 * np.std(noise)
    assert abs(np.corrcoef(clean - load, noise)[0, 1]) < 0.05


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_white_and_coloured_noise_are_told_apart(memory: float) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(60_000) * 1e-3
    kicks = rng.standard_normal(time.size)
    noise = np.empty_like(kicks)
    noise[0] = kicks[0]
    for k in range(1, noise.size):
        noise[k] = memory * noise[k - 1] + np.sqrt(1.0 - memory**2) * kicks[k]
    found = torque_noise(3.0 * np.sin(time) + 0.05 * noise)
    assert found.size == pytest.approx(0.05, rel=0.1)
    assert (found.coloured > found.white) == (memory > 0.0)


def test_a_lone_spike_is_taken_out_and_a_step_is_kept() -> None:
    step = np.where(np.arange(200) < 100, 0.0, 2.0)
    spiked = step.copy()
    spiked[50] = 30.0
    assert np.array_equal(without_spikes(spiked, 0.1), step)


def test_time_since_reversal_starts_anew_at_each_reversal() -> None:
    velocity = np.concatenate([np.full(100, 0.5), np.full(100, -0.5)])
    since = time_since_reversal(velocity, 1e-3)
    assert since[99] == pytest.approx(0.099)
    assert since[100] == 0.0


@pytest.mark.parametrize(
    ("kind", "period", "usual"),
    [("commanded", 1e-3, (-5e-4, 2.5e-4)), ("measured", 1e-3, (0.0, 2.5e-4)), ("commanded", 4e-3, (-2e-3, 1e-3))],
)
def test_a_command_acts_half_a_sample_late(kind: TorqueKind, period: float, usual: tuple[float, float]) -> None:
    time = np.arange(4000, dtype=np.float64) * np.float64(period)
    recording = Recording(time=time, position=np.sin(time), torque=np.cos(time))
    (track,) = build_tracks([recording.with_metadata(torque_kind=kind)])
    assert track.usual_delay == pytest.approx(usual)
