"""What a motion can show is said with figures, and a good one is left alone."""

import numpy as np
import pytest

from fricomp.calibration.motion.parts import read_motion_recording
from fricomp.errors import RecordingError
from fricomp.recording import Recording, check_recording
from fricomp.recording.checks.motion_kind import fit_clamp
from fricomp.recording.checks.torque_sensor import fit_two_torques

from ..joint_log import joint_log

_CODES = {"one_way", "one_way_turns", "held_output", "hand_motion", "silent_torque", "stepped"}


def _kinds(recording: Recording) -> dict[str, str]:
    return {one.code: one.message for one in check_recording(recording) if one.code in _CODES}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_motion_of_both_directions_is_no_special_one(seed: int) -> None:
    assert _kinds(joint_log(20.0, 400.0, seed)) == {}


def test_a_motion_in_one_direction_is_told_as_one() -> None:
    t = np.arange(0.0, 8.0, 2e-3)
    q = 0.4 * t + 0.05 * np.sin(2.0 * t)
    assert set(_kinds(Recording(t, q, 0.5 + 0.2 * np.gradient(q, t)))) == {"one_way"}


@pytest.mark.parametrize(("stiffness", "gap", "friction"), [(400.0, 0.03, 1.0), (1500.0, 0.01, 3.0)])
def test_a_held_output_shows_stiffness_gap_and_inner_friction(stiffness: float, gap: float, friction: float) -> None:
    t = np.arange(0.0, 60.0, 0.01)
    torque = 20.0 * np.sin(2.0 * np.pi * t / 12.0)
    passed = np.zeros_like(t)
    for k in range(1, t.size):
        passed[k] = np.clip(passed[k - 1], torque[k] - friction, torque[k] + friction)
    angle = passed / stiffness + 0.5 * gap * np.clip(passed / 1.0, -1.0, 1.0)
    noise = np.random.default_rng(0).normal(0.0, 1e-5, t.size)
    recording = Recording(t, angle + noise, torque)
    assert set(_kinds(recording)) == {"held_output"}
    clamp = fit_clamp(recording)
    assert clamp.stiffness == pytest.approx(stiffness, rel=0.15)
    assert clamp.gap == pytest.approx(gap, rel=0.15)
    assert clamp.friction == pytest.approx(friction, abs=0.4)
    assert clamp.residual < 0.2 * clamp.linear_residual


def test_a_way_of_many_turns_in_one_direction_shows_what_comes_again() -> None:
    t = np.arange(0.0, 20.0, 2e-3)
    q = 6.0 * t + 0.05 * np.sin(2.0 * t)
    assert set(_kinds(Recording(t, q, 0.5 + 0.02 * np.gradient(q, t) + 0.1 * np.sin(7.0 * q)))) == {"one_way_turns"}


@pytest.mark.parametrize("held", [30, 90])
def test_a_joint_that_is_moved_in_steps_gets_no_advice_on_signs(held: int) -> None:
    rng = np.random.default_rng(5)
    angle = 3e-4 * np.round(np.repeat(np.r_[0.0:1.0:0.004, 1.0:0.0:-0.004], held) / 3e-4)
    t = np.arange(float(angle.size)) * 0.01
    holding = 0.2 * np.sin(72.0 * angle) + rng.normal(0.0, 0.002, t.size)
    codes = {one.code for one in check_recording(Recording(t, angle, holding))}
    assert "stepped" in codes
    assert not codes & {"flipped_torque", "driven"}
    with pytest.raises(RecordingError, match="moved in"):
        read_motion_recording(Recording(t, angle, holding))


@pytest.mark.parametrize(("gain", "bend"), [(0.9, 0.0), (1.0, -0.1)])
def test_a_torque_sensor_tells_gain_and_saturation_of_the_motor(gain: float, bend: float) -> None:
    log = joint_log(30.0, 400.0, 6)
    load = log.torque * (gain + bend * np.asarray(log.torque) ** 2)
    noise = np.random.default_rng(6).normal(0.0, 0.01, len(log))
    fit = fit_two_torques(log.with_channels(load_torque=load + noise))
    assert fit is not None
    if bend == 0.0:
        assert fit.gain == pytest.approx(gain, abs=0.01)
    else:
        assert fit.small_gain == pytest.approx(gain, abs=0.03)
        assert fit.loss == pytest.approx(-bend * fit.largest**2, abs=0.03)
    codes = {one.code: str(one) for one in check_recording(log.with_channels(load_torque=load + noise))}
    assert ("saturates" in codes["torque_gain"]) == (bend < 0.0)
    assert "torque_gain" not in {one.code for one in check_recording(log.with_channels(load_torque=log.torque + noise))}


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_friction_at_rest_is_no_saturation_of_the_motor(seed: int) -> None:
    """A joint that its friction holds at all heights most of the time, so that the sensor reads gravity alone."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 40.0, 2e-3)
    spans = np.cumsum(rng.uniform(0.4, 1.6, 60))
    stops = rng.uniform(-1.2, 1.2, 60)
    part = np.minimum(np.searchsorted(spans, t), 58)
    since = np.clip((t - np.concatenate([[0.0], spans])[part]) / 0.3, 0.0, 1.0)
    q = stops[part] + (stops[part + 1] - stops[part]) * since**2 * (3.0 - 2.0 * since)
    v = np.gradient(q, t)
    load = 8.0 * np.sin(q) + 0.05 * np.gradient(v, t)
    held = np.convolve(rng.uniform(-0.9, 0.9, 60)[part], np.ones(25) / 25.0, "same") - 0.1 * load
    friction = np.where(np.abs(v) > 1e-3, np.sign(v) + 0.2 * v, held)
    noise = rng.normal(0.0, 0.01, (2, t.size))
    fit = fit_two_torques(Recording(t, q, load + friction + noise[0], load_torque=load + noise[1]))
    assert fit is not None
    assert not fit.saturates
    assert fit.gain == pytest.approx(1.0, abs=0.02)


def test_a_joint_that_is_moved_by_hand_shows_no_friction() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 30.0, 2e-3)
    q = 1.2 * np.sin(2.0 * np.pi * 0.13 * t) + 0.5 * np.sin(2.0 * np.pi * 0.31 * t + 1.0)
    said = _kinds(Recording(t, q, 3.0 * np.sin(q) + rng.normal(0.0, 0.01, t.size)))
    assert set(said) == {"hand_motion"}
    assert "does not say that there is none" in said["hand_motion"]


@pytest.mark.parametrize(("smoothed", "rate"), [(1, 50.0), (1, 500.0), (5, 500.0)])
def test_a_torque_that_is_noise_alone_is_refused_as_one(smoothed: int, rate: float) -> None:
    log = joint_log(20.0, rate, 6)
    noise = np.random.default_rng(7).normal(0.0, 0.01, len(log) + smoothed - 1)
    silent = log.with_channels(torque=np.convolve(noise, np.full(smoothed, 1.0 / smoothed), mode="valid"))
    assert set(_kinds(silent)) == {"silent_torque"}
    with pytest.raises(RecordingError, match="noise alone"):
        read_motion_recording(silent)


def test_a_noisy_torque_that_holds_friction_is_none() -> None:
    log = joint_log(20.0, 500.0, 8)
    noisy = log.torque + np.random.default_rng(9).normal(0.0, 3.0 * float(np.std(log.torque)), len(log))
    assert _kinds(log.with_channels(torque=noisy)) == {}


@pytest.mark.parametrize("gain", [1.0, 0.8])
def test_noise_in_both_torques_is_no_gain_of_a_chirp(gain: float) -> None:
    """In a chirp the inertia between both looks like more of the load: noise of the torque had lessened its gain."""
    rng = np.random.default_rng(17)
    t = np.arange(0.0, 30.0, 1e-3)
    phase = 2.0 * np.pi * np.cumsum(np.linspace(0.3, 4.0, t.size)) * 1e-3
    q = np.asarray(0.6 * np.sin(phase), dtype=np.float64)
    velocity = np.gradient(q, t)
    turned = 0.008 * np.gradient(velocity, t)
    load = 0.02 * np.gradient(velocity, t) + 2.0 * np.sin(q)
    noise = rng.normal(0.0, 0.2, (2, t.size))
    motor = load / gain + turned + 0.3 * np.tanh(velocity / 0.02) + noise[0]
    fit = fit_two_torques(Recording(t, q, motor, load_torque=load + noise[1]))
    assert fit is not None
    assert fit.is_off == (gain != 1.0)
    assert abs(fit.gain - gain) < 2.0 * fit.gain_deviation
