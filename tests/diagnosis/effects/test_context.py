"""What effects are computed from carries no sensor noise."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fricomp.diagnosis.effects import Context
from fricomp.diagnosis.effects.context import _correct_position, remove_noise
from fricomp.diagnosis.effects.effect import compute_lowest_order
from fricomp.diagnosis.inputs.spikes import take_out_spikes
from fricomp.diagnosis.inputs.track import Track, measure_torque_noise
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observation, Plant
from fricomp.diagnosis.search.generic import measure_time_since_reversal
from fricomp.diagnosis.search.refit import rebuild_contexts
from fricomp.recording import Recording
from fricomp.recording.metadata import TorqueKind


def test_a_recorded_load_loses_its_noise_and_keeps_its_shape() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(20_000) * 1e-3
    position = 0.8 * np.sin(time)
    acceleration = -position
    load = 5.0 * np.sin(position + 0.3) + 0.2 * acceleration
    track = Track.build(1e-3, position, load)
    noise = 0.05 * rng.standard_normal(time.size)
    clean = remove_noise(load + noise, position, acceleration, track)
    assert np.std(clean - load) < 0.05 * np.std(noise)
    assert abs(np.corrcoef(clean - load, noise)[0, 1]) < 0.05


@pytest.mark.parametrize(("swing", "off"), [(0.0, 0.08), (20.0, 1.0)])
def test_rounding_of_the_encoder_is_no_motion_and_what_it_contradicts_is(swing: float, off: float) -> None:
    step, time = 5e-5, np.arange(4000) * 1e-3
    model = 0.3 * np.sin(2.0 * time)
    drift, fast = 3.0 * step * np.cos(time), swing * step * np.sin(2.0 * np.pi * 20.0 * time)
    track = Track.build(1e-3, np.round((model + drift + fast) / step) * step, np.zeros_like(time))
    position = _correct_position(track, Observation(model, model, model, model))
    error = (position - model - drift - fast)[200:-200] / step
    assert np.std(error) < off  # of a step; rounding is 0.29, and 0.13 over 15 ms


def test_effects_follow_the_joint_that_was_found_and_not_the_one_without_them() -> None:
    step, time = 5e-5, np.arange(4000) * 1e-3
    zero, curve = np.zeros_like(time), (2.0, 3.0, 0.05, 1.0)
    there = 0.3 * np.sin(2.0 * time) + 0.8 * step * np.sin(2.0 * np.pi * 20.0 * time)
    track = Track.build(1e-3, np.round(there / step) * step, zero)
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, 4e4)
    before = Context(1e-3, 0.3 * np.sin(2.0 * time), zero, zero, zero, zero, zero, zero, zero, plant, True, 2.0)
    seen = [Observation(zero, there, zero, zero)]
    structure = SimpleNamespace(observe=lambda *_: seen, move_contexts=lambda _: (before,))
    explanation = SimpleNamespace(structure=structure, fit=SimpleNamespace(theta=zero))
    baseline = SimpleNamespace(problem=SimpleNamespace(tracks=(track,)))
    (after,) = rebuild_contexts(cast(Any, baseline), cast(Any, explanation))
    assert np.std((after.position - there)[200:-200]) < 0.1 * step


def test_a_joint_that_runs_away_moves_no_effect() -> None:
    zero, curve = np.zeros(400), (2.0, 3.0, 0.05, 1.0)
    track = Track.build(1e-3, zero, zero)
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, 4e4)
    before = Context(1e-3, zero, zero, zero, zero, zero, zero, zero, zero, plant, True, 2.0)
    lost = np.where(np.arange(400) < 300, 0.0, np.nan)
    structure = SimpleNamespace(
        observe=lambda *_: [Observation(zero, lost, zero, zero)], move_contexts=lambda _: (before,)
    )
    explanation = SimpleNamespace(structure=structure, fit=SimpleNamespace(theta=zero))
    baseline = SimpleNamespace(problem=SimpleNamespace(tracks=(track,)))
    assert rebuild_contexts(cast(Any, baseline), cast(Any, explanation)) == (before,)


@pytest.mark.parametrize(("strokes", "waves"), [(1, 3.0), (2, 1.5), (8, 1.5)])
def test_a_ripple_of_a_single_stroke_needs_more_waves_than_the_range_must_hold(strokes: int, waves: float) -> None:
    time = np.linspace(0.0, np.pi * strokes, 4000)
    zero, curve, step = np.zeros_like(time), (2.0, 3.0, 0.05, 1.0), float(time[1])
    plant = Plant(0.5, (0.0, 0.0), 0.0, curve, curve, 4e4)
    position, velocity = np.cos(time), -np.sin(time)
    context = Context(step, position, velocity, zero, zero, zero, zero, zero, zero, plant, True, 2.0)
    assert compute_lowest_order([context]) == pytest.approx(waves * np.pi, rel=1e-3)


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_white_and_coloured_noise_are_told_apart(memory: float) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(60_000) * 1e-3
    kicks = rng.standard_normal(time.size)
    noise = np.empty_like(kicks)
    noise[0] = kicks[0]
    for k in range(1, noise.size):
        noise[k] = memory * noise[k - 1] + np.sqrt(1.0 - memory**2) * kicks[k]
    found = measure_torque_noise(3.0 * np.sin(time) + 0.05 * noise)
    assert found.size == pytest.approx(0.05, rel=0.1)
    assert (found.coloured > found.white) == (memory > 0.0)


def test_a_lone_spike_is_taken_out_and_a_step_is_kept() -> None:
    step = np.where(np.arange(200) < 100, 0.0, 2.0)
    spiked = step.copy()
    spiked[50] = 30.0
    assert np.array_equal(take_out_spikes(spiked, 0.1), step)


@pytest.mark.parametrize("width", [1, 2, 3])
def test_few_samples_that_come_and_go_are_taken_out(width: int) -> None:
    noise = 0.1 * np.random.default_rng(2).standard_normal(400)
    spiked = noise.copy()
    spiked[200 : 200 + width] += 3.0
    for slow in (False, True):
        changed = np.flatnonzero(take_out_spikes(spiked, 0.1, slow=slow) != spiked)
        assert changed.tolist() == list(range(200, 200 + width))


@pytest.mark.parametrize("rate", [100.0, 150.0, 200.0])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.6, 0.9])
def test_the_peak_with_which_a_loop_answers_a_reversal_is_no_spike(rate: float, phase: float) -> None:
    """A joint that sticks and breaks free: a swing of 0.04 s, which 100 samples a second show in three or four."""
    since = (np.arange(200) + phase) / rate - 100.0 / rate
    swing = np.where(since > 0.0, 2.0 - 2.0 * np.exp(-since / 0.04) * np.cos(2.0 * np.pi * since / 0.08), 0.0)
    torque = swing - 1.0 + 0.01 * np.random.default_rng(3).standard_normal(200)
    assert np.array_equal(take_out_spikes(torque, 0.01, slow=True), torque)


def test_time_since_reversal_starts_anew_at_each_reversal() -> None:
    velocity = np.concatenate([np.full(100, 0.5), np.full(100, -0.5)])
    since = measure_time_since_reversal(velocity, 1e-3)
    assert since[99] == pytest.approx(0.099)
    assert since[100] == 0.0


@pytest.mark.parametrize(
    ("kind", "period", "usual"),
    [
        ("commanded", 1e-3, (-5e-4, 2.5e-4)),
        ("measured", 1e-3, (0.0, 2.5e-4)),
        ("commanded", 4e-3, (-2e-3, 1e-3)),
        ("commanded", 1e-2, (-5e-3, 2.5e-3)),
    ],
)
def test_a_command_acts_half_a_sample_late(kind: TorqueKind, period: float, usual: tuple[float, float]) -> None:
    """And the base has room for that, though slow recordings are simulated on a finer grid."""
    time = np.arange(4000, dtype=np.float64) * np.float64(period)
    recording = Recording(time=time, position=np.sin(time), torque=np.cos(time))
    (track,) = build_tracks([recording.with_metadata(torque_kind=kind)])
    assert track.usual_delay == pytest.approx(usual)
    earliest, latest = track.delays
    assert earliest <= usual[0] - 0.5 * usual[1] or period < 2e-3
    assert earliest <= -0.499 * period
    assert latest >= 0.499 * period
