from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.calibration.motion.joint_samples import JointSamples, RegressionSettings, sample_joint, split_for
from fricomp.calibration.motion.rigid_body import fit_rigid_body
from fricomp.errors import IdentificationError
from fricomp.laws import BidirectionalStribeck, Coulomb, FloatArray, FrictionLaw, StribeckCurve, Viscous
from fricomp.model import FrictionModel
from fricomp.recording import Recording
from fricomp.recording.public import find_public_data, read_public
from fricomp.sim_bench.stand_in.plant import Plant

no_emps = pytest.mark.skipif(find_public_data("emps") is None, reason="the public set emps is not here: FRICOMP_DATA")
no_ur10e = pytest.mark.skipif(
    find_public_data("ur10e") is None, reason="the public set ur10e is not here: FRICOMP_DATA"
)


def _recording() -> Recording:
    t = np.arange(0.0, 20.0, 1e-3)
    q = np.sin(1.3 * t) + 0.4 * np.sin(3.1 * t + 0.5)
    v = 1.3 * np.cos(1.3 * t) + 1.24 * np.cos(3.1 * t + 0.5)
    a = -1.69 * np.sin(1.3 * t) - 3.844 * np.sin(3.1 * t + 0.5)
    torque = 0.8 * a + 0.5 * v + 0.3 * np.sign(v) + 0.1 + 2.0 * np.cos(q) - 1.0 * np.sin(q)
    return Recording(t, q, torque + 0.02 * np.random.default_rng(0).normal(size=len(t)))


def test_recovers_inertia_gravity_offset_and_friction() -> None:
    fit = fit_rigid_body(sample_joint(_recording()), gravity=True)
    found = (fit.inertia, fit.viscous_coefficient, fit.coulomb_torque, *fit.gravity)
    np.testing.assert_allclose(found, (0.8, 0.5, 0.3, 2.0, -1.0), rtol=0.02)
    assert fit.offset == pytest.approx(0.1, abs=0.05)


def test_a_rate_that_rounding_takes_below_a_whole_number_is_that_number() -> None:
    recording = _recording().rows(slice(0, 20000, 2))
    exact = Recording(np.arange(10000) / 500.0, recording.position, recording.torque)
    below = Recording(exact.time * (1.0 + 1e-9), recording.position, recording.torque)
    assert len(sample_joint(below).torque) == len(sample_joint(exact).torque)


def test_a_motion_at_rest_is_refused() -> None:
    t = np.arange(0.0, 2.0, 1e-3)
    with pytest.raises(IdentificationError, match="several speeds"):
        fit_rigid_body(sample_joint(Recording(t, np.zeros_like(t), np.zeros_like(t))))
    samples = sample_joint(_recording())
    with pytest.raises(IdentificationError):
        fit_rigid_body(samples, rows=np.zeros(len(samples.torque), dtype=bool))


@no_emps
def test_reproduces_the_published_emps_reference() -> None:
    (train,) = read_public("emps/train")
    fit = fit_rigid_body(sample_joint(train))
    found = (fit.inertia, fit.viscous_coefficient, fit.coulomb_torque, fit.offset)
    np.testing.assert_allclose(found, (95.109, 203.50, 20.394, -3.165), rtol=0.005)


def prediction_error(fit: MotionIdentification, samples: JointSamples, model: FrictionModel | None = None) -> float:
    """Root mean square error of the torque of data that the fit did not see, as a fraction of the torque's.

    With the friction of `model` in place of the fit's where it is given.
    """
    friction = np.asarray((model or fit.friction.model).torque(np.asarray(samples.velocity)))
    error = samples.torque - fit.rigid_body.rigid_torque(samples) - np.abs(friction) * samples.direction
    return float(np.sqrt(np.mean(error**2) / np.mean(samples.torque**2)))


@pytest.mark.slow
@no_emps
def test_bidirectional_stribeck_predicts_the_emps_pulse_test_better_than_coulomb_viscous() -> None:
    settings = RegressionSettings(torque_cutoff=20.0)
    (train,), (pulses,) = read_public("emps/train"), read_public("emps/pulses")
    fit = identify_motion(sample_joint(train, settings), settings)
    body = fit.rigid_body
    simple = FrictionModel(FrictionLaw((Coulomb(body.coulomb_torque), Viscous(body.viscous_coefficient))))
    held_out = sample_joint(pulses, settings)
    error = prediction_error(fit, held_out)
    assert error < 0.036
    assert error < 0.85 * prediction_error(fit, held_out, simple)


def _cut(samples: JointSamples, begin: float, end: float) -> JointSamples:
    """The part from `begin` to `end`, as fractions of the whole."""
    n = len(samples.torque)
    part = slice(round(begin * n), round(end * n))
    columns = {name: values[part] for name, values in vars(samples).items() if name != "recorded"}
    return JointSamples(**columns, recorded=replace(samples.recorded, index=samples.recorded.index[part]))


@pytest.mark.slow
@no_ur10e
def test_stribeck_predicts_the_second_half_of_ur10e_joint_1_better_than_coulomb_viscous() -> None:
    (recording,) = read_public("ur10e/joint_1")
    settings = RegressionSettings(position_cutoff=5.0, torque_cutoff=5.0, slowest=0.03)
    samples, end = sample_joint(recording, settings), float(recording.time[-1])
    fit = identify_motion(_cut(samples, 10.0 / end, 35.0 / end), settings)
    body = fit.rigid_body
    simple = FrictionModel(FrictionLaw((Coulomb(body.coulomb_torque), Viscous(body.viscous_coefficient))))
    held_out = _cut(samples, 35.0 / end, 60.0 / end)
    error = prediction_error(fit, held_out)
    assert error < 0.03
    assert error < 0.85 * prediction_error(fit, held_out, simple)


_BOTH = FrictionLaw((BidirectionalStribeck(StribeckCurve(0.15, 0.6, 0.05, 0.02), StribeckCurve(0.2, 0.7, 0.05, 0.03)),))


def _late(
    delay: float,
    inertia: float = 0.1,
    swings: tuple[float, ...] = (0.8, 0.15),
    law: FrictionLaw = _BOTH,
    noise: float = 0.005,
) -> Recording:
    """Swings at 0.2 and 0.9 Hz, with a torque that comes `delay` [s] late."""
    t = np.arange(0.0, 40.0, 2e-3)
    rates, phases = np.array([0.4, 1.8])[: len(swings), None] * np.pi, np.array([0.0, 1.0])[: len(swings), None]
    angles, size = rates * (t - delay) + phases, np.array(swings)[:, None]
    v, a = np.sum(size * rates * np.cos(angles), axis=0), np.sum(-size * rates**2 * np.sin(angles), axis=0)
    torque = inertia * a + np.asarray(law.torque(v)) + np.random.default_rng(2).normal(0.0, noise, t.size)
    return Recording(t, np.sum(size * np.sin(rates * t + phases), axis=0), torque)


def _largest_error(found: MotionIdentification) -> float:
    """Of the friction parameters, in standard deviations."""
    friction, true = found.friction, _BOTH.parameters()
    return max(
        abs(value - true[name]) / friction.standard_deviations[name] for name, value in friction.parameters.items()
    )


def test_friction_that_differs_between_directions_is_not_taken_for_an_offset() -> None:
    found = identify_motion(sample_joint(_late(0.0)))
    assert found.rigid_body.offset == 0.0
    assert found.rigid_body.inertia == pytest.approx(0.1, rel=1e-3)
    assert _largest_error(found) < 3.0
    assert abs(found.lag.value) < 3.0 * found.lag.deviation < 2e-4
    assert "cannot be told from friction" in found.friction.message
    assert found.friction.model.provenance.notes["torque_offset"].startswith("0 assumed")


@pytest.mark.slow
@pytest.mark.parametrize(("delay", "inertia"), [(0.003, 0.5), (-0.005, 0.1), (0.02, 0.1)])
def test_a_torque_that_comes_late_or_early_is_shifted_and_gives_the_same_friction(delay: float, inertia: float) -> None:
    found = identify_motion(sample_joint(_late(delay, inertia)))
    assert abs(found.lag.value - delay) < 3.0 * found.lag.deviation < 2e-4
    assert found.rigid_body.inertia == pytest.approx(inertia, rel=1e-3)
    assert found.rigid_body.viscous_coefficient == pytest.approx(0.0179, abs=0.001)  # as without a delay
    assert _largest_error(found) < 3.0
    assert found.friction.model.provenance.notes["torque_age"].startswith(f"{found.lag.value:.3g} +- ")
    assert ("check both time stamps" in found.lag.sentence) == (delay == 0.02)


_PLAIN = FrictionLaw((Coulomb(0.05), Viscous(0.1)))


def test_a_lag_that_the_motion_does_not_tell_is_in_the_deviations() -> None:
    one_swing = _late(0.003, inertia=0.5, swings=(0.8,), law=_PLAIN, noise=0.03)  # late inertia is viscous friction
    found = identify_motion(sample_joint(one_swing), law="coulomb_viscous")
    assert "does not tell how late" in found.lag.sentence
    assert found.lag.deviation == pytest.approx(0.004, rel=0.2)
    name = "viscous.viscous_coefficient"
    deviation = found.friction.standard_deviations[name]
    assert abs(found.friction.parameters[name] - 0.1) < 2.0 * deviation < 0.05


def test_a_lag_beyond_what_can_be_taken_off_is_no_convergence() -> None:
    found = identify_motion(sample_joint(_late(0.08, law=_PLAIN)), law="coulomb_viscous")
    assert found.friction.status == "not_converged"
    assert "check the time stamps" in found.friction.model.provenance.message


def test_an_offset_larger_than_friction_stays_an_offset() -> None:
    t = np.arange(0.0, 20.0, 2e-3)
    q = np.sin(1.3 * t) + 0.4 * np.sin(3.1 * t + 0.5)
    v = np.gradient(q, t)
    torque = 0.1 * np.gradient(v, t) + 0.2 * np.sign(v) + 0.1 * v + 1.5
    torque = torque + np.random.default_rng(0).normal(0.0, 0.005, t.size)
    found = identify_motion(sample_joint(Recording(t, q, torque)))
    assert found.rigid_body.offset == pytest.approx(1.5, rel=0.01)
    assert found.friction.parameters["stribeck.forward.coulomb_torque"] == pytest.approx(0.2, rel=0.1)


def test_each_part_between_gaps_is_filtered_on_its_own() -> None:
    whole = _recording()
    cut = whole.rows((whole.time < 6.0) | ((whole.time > 13.0) & (whole.time < 13.1)) | (whole.time > 14.0))
    parts = split_for(cut)
    assert [len(part) for part in parts.parts] == [6000, 5999]
    assert parts.short == pytest.approx((0.098,))
    assert "1 too short for that, 0.098 s in all" in parts.notes[0]
    fit = fit_rigid_body(sample_joint(cut), gravity=True)
    found = (fit.inertia, fit.viscous_coefficient, fit.coulomb_torque, *fit.gravity)
    np.testing.assert_allclose(found, (0.8, 0.5, 0.3, 2.0, -1.0), rtol=0.02)


def test_gaps_shorter_than_the_filters_see_are_bridged() -> None:
    whole = _recording()
    keep = np.ones(len(whole), dtype=bool)
    keep[5000:5006] = False
    assert len(split_for(whole.rows(keep)).parts) == 1
    assert split_for(whole.rows(keep)).notes == ()


_PENDULUM = """<mujoco><compiler angle="radian"/><worldbody><body>
<joint name="knee" axis="0 1 0" armature="0.05"/>
<inertial pos="0 0 -0.2" mass="2" diaginertia="0.03 0.03 0.03"/></body></worldbody></mujoco>"""
"""0.05 + 0.03 + 2 0.2² = 0.16 kg·m²; 2 9.81 0.2 = 3.924 N·m at a quarter turn."""
_KNEE = BidirectionalStribeck(StribeckCurve(1.5, 2.0, 0.12, 0.6), StribeckCurve(1.06, 1.41, 0.12, 0.6))


def _trapezoids(speeds: tuple[float, ...], moves: int) -> FloatArray:
    """Positions of moves to and fro at 1 kHz, with 12 rad/s² and 0.3 s of rest after each [rad]."""
    parts = []
    for move in range(moves):
        ramp = np.arange(0.0, speeds[move % len(speeds)], 0.012)
        way = 0.4 if move == 0 else 0.6 + 0.2 * (move % 3)  # so that they turn at different angles
        hold = max(int((way - 1e-3 * 2.0 * ramp.sum()) / (1e-3 * ramp[-1])), 0)
        speed = np.concatenate([ramp, np.full(hold, ramp[-1]), ramp[::-1], np.zeros(300)])
        parts.append(speed if move % 2 else -speed)
    return np.cumsum(np.concatenate(parts)) * 1e-3


def _rested(folder: Path, seed: int) -> Recording:
    """A stand-in pendulum that follows trapezoids with rests under a position loop; encoder of 18 bits."""
    (folder / "knee.xml").write_text(_PENDULUM)
    plant = Plant(folder / "knee.xml", ("knee",), (FrictionLaw((_KNEE,)),))
    wanted, step = _trapezoids((0.6, 0.25, 1.2, 0.1, 2.0, 0.4, 0.9), 24), 2.0 * np.pi / 2**18
    measured, torque = np.empty(len(wanted)), np.empty(len(wanted))
    for k, speed in enumerate(np.gradient(wanted, 1e-3)):
        measured[k] = np.round(plant.position(0) / step) * step
        torque[k] = 120.0 * (wanted[k] - measured[k]) + 6.0 * (speed - plant.velocity(0))
        plant.step([torque[k]])
    noise = np.random.default_rng(seed).normal(0.0, 0.06, len(wanted))
    return Recording(1e-3 * np.arange(len(wanted), dtype=np.float64), measured, torque + noise)


def test_what_friction_holds_at_rest_is_neither_gravity_nor_inertia(tmp_path: Path) -> None:
    recording = _rested(tmp_path, 3)
    settings = choose_settings(recording, gravity=True)
    found = identify_motion(sample_joint(recording, settings), settings)
    body, friction = found.rigid_body, found.friction
    assert body.inertia == pytest.approx(0.16, rel=0.01)
    assert body.gravity == pytest.approx((0.0, 3.924), abs=0.04)
    assert friction.parameters["stribeck.forward.coulomb_torque"] == pytest.approx(1.5, rel=0.03)
    assert friction.parameters["stribeck.reverse.coulomb_torque"] == pytest.approx(1.06, rel=0.03)
    assert friction.status == "converged"
    true = FrictionLaw((_KNEE,)).parameters()
    for name in ("stribeck.forward.coulomb_torque", "stribeck.reverse.coulomb_torque"):
        assert abs(friction.parameters[name] - true[name]) < 4.0 * friction.standard_deviations[name], name
    assert abs(body.inertia - 0.16) < 4.0 * body.standard_deviations[0]
    assert abs(body.gravity[1] - 3.924) < 4.0 * body.gravity_deviations[1]


def test_a_motion_that_hardly_slides_is_refused() -> None:
    t = np.arange(0.0, 20.0, 1e-3)
    q = 0.3 * np.clip(t - 10.0, 0.0, 0.5)  # half a second of sliding in twenty
    with pytest.raises(IdentificationError, match="slide in one direction"):
        identify_motion(sample_joint(Recording(t, q, np.sign(np.gradient(q)))))


def test_a_coarse_encoder_gets_a_lower_low_pass_and_the_same_inertia() -> None:
    fine = _recording()
    step = 2.0 * np.pi / 2**12
    coarse = fine.with_channels(position=np.round(fine.position / step) * step)
    settings = choose_settings(coarse, gravity=True)
    assert settings.torque_cutoff < choose_settings(fine, gravity=True).torque_cutoff
    assert fit_rigid_body(sample_joint(coarse, settings), gravity=True).inertia == pytest.approx(0.8, rel=0.01)
