"""The noise of a recording is seen, and given to one without."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.inputs.sensor_noise import add_sensor_noise, measure_sensor_noise
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.recording import Recording

STEP, HISS, BLUR = 2.0 * np.pi / 2**18, 0.03, 2e-5


def _recording(rate: float = 1000.0, hiss: float = 0.0, blur: float = 0.0, step: float = 0.0) -> Recording:
    """A smooth motion of 12 s with noise of torque [N·m] and position [rad], and an encoder's step [rad]."""
    rng = np.random.default_rng(1)
    time: FloatArray = np.arange(round(12.0 * rate)) / np.float64(rate)
    position = 0.7 * np.sin(1.3 * time) + 0.2 * np.sin(4.1 * time)
    torque = 3.0 * np.sin(position) + np.tanh(np.gradient(position, time) / 0.02)
    position = position + blur * rng.standard_normal(time.size)
    position = np.round(position / step) * step if step else position
    return Recording(time, position, torque + hiss * rng.standard_normal(time.size), position_reference=position)


def test_noise_of_torque_and_position_is_seen() -> None:
    rounded = measure_sensor_noise(_recording(hiss=HISS, step=STEP))
    assert rounded.torque == pytest.approx(HISS, rel=0.05)
    assert rounded.encoder_step == pytest.approx(STEP, rel=1e-6)
    assert rounded.position == 0.0
    blurred = measure_sensor_noise(_recording(hiss=HISS, blur=BLUR))
    assert blurred.position == pytest.approx(BLUR, rel=0.1)
    assert blurred.encoder_step == 0.0


@pytest.mark.parametrize(("step", "blur"), [(STEP, 0.0), (0.0, BLUR)])
def test_a_recording_without_noise_gets_it_and_one_that_has_it_does_not(step: float, blur: float) -> None:
    real, bare = _recording(hiss=HISS, step=step, blur=blur), _recording()
    sensed = add_sensor_noise(bare, [real])
    ours, theirs = measure_sensor_noise(sensed), measure_sensor_noise(real)
    assert ours.torque == pytest.approx(theirs.torque, rel=0.05)
    assert ours.position == pytest.approx(theirs.position, rel=0.1)
    assert ours.encoder_step == pytest.approx(theirs.encoder_step)
    assert sensed.position_reference is None
    assert np.array_equal(sensed.torque, add_sensor_noise(bare, [real]).torque)
    assert not np.array_equal(sensed.torque, add_sensor_noise(bare, [real], seed=1).torque)
    louder = _recording(hiss=1.2 * HISS, step=2.0 * step, blur=1.2 * blur)
    assert add_sensor_noise(louder, [real]) is louder


def test_the_quietest_counts_and_noise_weighs_as_much_in_more_samples() -> None:
    quiet, loud = _recording(hiss=HISS, step=STEP), _recording(hiss=3.0 * HISS, step=4.0 * STEP)
    sensed = measure_sensor_noise(add_sensor_noise(_recording(), [loud, quiet]))
    assert sensed.torque == pytest.approx(HISS, rel=0.05)
    assert sensed.encoder_step == pytest.approx(STEP, rel=1e-6)
    slow = _recording(rate=250.0, hiss=HISS, step=STEP)
    assert measure_sensor_noise(add_sensor_noise(_recording(), [slow])).torque == pytest.approx(2.0 * HISS, rel=0.1)


def test_sensors_without_visible_noise_count_as_very_good_ones() -> None:
    bare = _recording()
    assert measure_sensor_noise(add_sensor_noise(bare, [bare])).torque == pytest.approx(
        1e-3 * np.std(bare.torque), rel=0.05
    )
    amperes = _recording(hiss=HISS, step=STEP).with_metadata(torque_unit="A")
    amperes = amperes.with_channels(torque=0.5 * amperes.torque)
    assert measure_sensor_noise(add_sensor_noise(bare, [amperes])).torque == pytest.approx(HISS, rel=0.06)
