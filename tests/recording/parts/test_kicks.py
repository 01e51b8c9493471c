"""Kicks of a controller are kept, jumps of a torque sensor are not."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.inputs.spikes import remove_spikes
from fricomp.recording import Recording
from fricomp.recording.parts.strays import find_wild_torque


@pytest.mark.parametrize("period", [1e-3, 4e-3, 1e-2])
@pytest.mark.parametrize("bits", [12, 16])
@pytest.mark.parametrize("samples", [1, 2])
def test_a_kick_that_the_joint_answers_is_kept_and_one_that_it_does_not_answer_is_not(
    period: float, bits: int, samples: int
) -> None:
    """A step of the set point kicks for a sample or two at 8 s; at 20 s the sensor alone jumps as far."""
    rng = np.random.default_rng(bits + samples)
    time = np.arange(round(30.0 / period), dtype=np.float64) * np.float64(period)
    inertia, kicked, jumped = 0.05, round(8.0 / period), round(20.0 / period)
    motion = np.sin(0.8 * time)
    torque = inertia * -0.64 * motion + 0.2 * motion + 0.1 * np.sign(np.cos(0.8 * time)) + 0.16 * np.cos(0.8 * time)
    torque += 0.01 * rng.standard_normal(time.size)
    size = 0.05 / (samples * period)  # changes the speed by 1 rad/s, and is taken back over the next half second
    late = np.clip(time - time[kicked] - 0.5 * samples * period, 0.0, None)
    position = motion + np.where(late < 0.5, late - late**2, 0.25)
    torque -= np.where((late > 0.0) & (late < 0.5), inertia * 2.0, 0.0)
    calm = torque.copy()
    torque[kicked : kicked + samples] += size
    torque[jumped : jumped + samples] += size
    step = 2.0 * np.pi / 2**bits
    found = remove_spikes(torque, 0.01, np.round(position / step) * step, period)
    np.testing.assert_array_equal(found[kicked : kicked + samples], torque[kicked : kicked + samples])
    assert np.max(np.abs(found - calm)[jumped - 20 : jumped + 20]) < 0.1
    wild = find_wild_torque(Recording(time=time, position=np.round(position / step) * step, torque=torque)).rows
    assert not wild[kicked - 20 : kicked + 20].any()
    assert wild[jumped : jumped + samples].all()
