"""At 10 to 60 Hz the diagnosis names what sliding shows, and says what falls between the samples."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.diagnosis.inputs.given import Given
from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.low_rate.answer import describe_slow_motion, is_low_rate
from fricomp.diagnosis.low_rate.held_out import fit_held_out
from fricomp.diagnosis.low_rate.models import add_drag, add_spring, write_plain_model
from fricomp.diagnosis.low_rate.search import Found, _leave_out_needless
from fricomp.evaluation import join_motions, read_motion
from fricomp.recording import Recording, RecordingMetadata

from .slow_joint import COULOMB, INERTIA, VISCOUS, slow_log


@pytest.mark.parametrize(
    ("rate", "seed", "gravity"),
    [
        (50.0, 21, 0.0),
        pytest.param(25.0, 22, 2.5, marks=pytest.mark.slow),
        pytest.param(12.5, 23, 0.0, marks=pytest.mark.slow),
    ],
)
def test_a_plain_joint_is_consistent_and_its_numbers_lie_in_their_intervals(
    rate: float, seed: int, gravity: float
) -> None:
    record = diagnose(slow_log(rate, seed, gravity=gravity)).record
    assert record.verdict == "consistent"
    assert not record.effects
    truth = {"coulomb_torque": COULOMB, "viscous_coefficient": VISCOUS, "gravity_sine": gravity}
    for name, value in truth.items():
        low, high = record.base[name].ci95
        assert low - 0.01 <= value <= high + 0.01, name
    assert record.base["inertia"].value == pytest.approx(INERTIA, rel=0.15)
    assert any("fall between the samples" in sentence for sentence in record.sentences)


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "seed", "load"), [(50.0, 31, 0.12), (20.0, 32, 0.2)])
def test_friction_that_grows_with_the_load_is_named(rate: float, seed: int, load: float) -> None:
    diagnosis = diagnose(slow_log(rate, seed, gravity=3.5, load=load))
    (effect,) = diagnosis.effects
    assert (diagnosis.verdict, effect.name) == ("missing_physics", "load_coulomb")
    low, high = effect.parameters["coefficient"].ci95
    assert low - 0.01 <= load <= high + 0.01
    assert diagnosis.extended_model is not None
    assert diagnosis.record.errors is not None
    assert diagnosis.record.errors.after is not None
    assert diagnosis.record.errors.after.torque.rms < 0.5 * diagnosis.record.errors.before.torque.rms


@pytest.mark.slow
@pytest.mark.parametrize(("size", "order"), [(0.1, 7.0), (0.2, 4.0)])
def test_a_ripple_within_the_band_is_named(size: float, order: float) -> None:
    (effect,) = diagnose(slow_log(40.0, 41, ripple=(size, order))).effects
    assert effect.name == "cogging"
    low, high = effect.parameters["order"].ci95
    assert low <= order <= high
    assert effect.parameters["sine"].value == pytest.approx(size, rel=0.1)


def _simulate(inertia: float = INERTIA, gravity: float = 0.0) -> RigidJoint:
    """What a simulation says of the joint."""
    return RigidJoint(inertia, (0.0, gravity), 0.0, VISCOUS, COULOMB, rotary=True)


@pytest.mark.slow
def test_a_spring_is_no_gravity_that_the_simulation_lacks() -> None:
    diagnosis = diagnose(slow_log(40.0, 81, more=lambda q, v: 0.5 * (q - 0.3)), _simulate())
    (effect,) = diagnosis.effects
    assert (diagnosis.verdict, effect.name) == ("missing_physics", "spring_torque")
    low, high = effect.parameters["stiffness"].ci95
    assert low <= 0.5 <= high


@pytest.mark.slow
def test_a_stop_is_named_with_its_edge() -> None:
    (effect,) = diagnose(slow_log(50.0, 82, more=lambda q, v: -20.0 * max(-q - 1.0, 0.0))).effects
    assert effect.name == "end_stop"
    assert effect.parameters["edge"].value == pytest.approx(-1.0, abs=0.03)
    assert effect.parameters["stiffness"].value == pytest.approx(20.0, rel=0.1)


@pytest.mark.slow
def test_a_drag_is_named_though_viscous_friction_makes_up_for_most_of_it() -> None:
    (effect,) = diagnose(slow_log(40.0, 85, more=lambda q, v: 0.25 * v * abs(v))).effects
    assert effect.name == "quadratic_drag"
    low, high = effect.parameters["coefficient"].ci95
    assert low <= 0.25 <= high


@pytest.mark.slow
def test_friction_that_waves_with_the_angle_is_named() -> None:
    level = 0.15
    (effect,) = diagnose(slow_log(40.0, 83, more=lambda q, v: level * np.cos(4.0 * q) * np.sign(v))).effects
    assert effect.name == "position_coulomb"
    low, high = effect.parameters["order"].ci95
    assert low <= 4.0 <= high
    assert effect.parameters["cosine"].value == pytest.approx(level, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "name"),
    [(_simulate(gravity=2.5), ""), (_simulate(gravity=2.0), "payload_error"), (_simulate(0.04, 2.5), "inertia_error")],
)
def test_what_a_simulation_has_wrong_is_named(given: RigidJoint, name: str) -> None:
    record = diagnose(slow_log(50.0, 84, gravity=2.5), given).record
    assert [one.name for one in record.effects] == ([name] if name else [])
    assert record.verdict == ("parameters" if name else "consistent")
    assert bool(record.changes) == bool(name)
    assert record.heldout is not None
    assert (record.heldout.before == "given") == bool(name)
    assert (record.heldout.rmse_before > 1.2 * record.heldout.rmse_after) == bool(name)


@pytest.mark.slow
def test_a_torque_that_is_stamped_late_is_a_measurement() -> None:
    diagnosis = diagnose(slow_log(25.0, 51, delay=0.07))
    (effect,) = diagnosis.effects
    assert (diagnosis.verdict, effect.name) == ("measurement", "torque_delay")
    low, high = effect.parameters["torque_delay"].ci95
    assert low - 0.003 <= -0.07 <= high + 0.003 or low - 0.003 <= 0.07 <= high + 0.003


@pytest.mark.slow
@pytest.mark.parametrize(("ripple", "names"), [(0.0, []), (0.2, ["cogging"])])
def test_a_motion_in_one_direction_names_what_depends_on_the_angle_alone(ripple: float, names: list[str]) -> None:
    t = np.arange(0.0, 80.0, 0.04)
    speed, late = (2.0 + 1.1 * np.sin(1.3 * s) + 0.6 * np.sin(3.1 * s) for s in (t, t - 0.09))
    q = np.cumsum(speed) * 0.04
    torque = 0.5 + 0.1 * late + 0.3 * np.gradient(late, t) + ripple * np.sin(1.5 * q)
    noise = 0.005 * np.random.default_rng(52).standard_normal(t.size)
    found = diagnose(Recording(t, q, torque + noise, metadata=RecordingMetadata(continuous=True)))
    assert [one.name for one in found.effects] == names
    assert any(one.startswith("torque_delay is not named") for one in found.sentences)


def test_an_effect_that_stood_in_for_a_later_one_goes_and_the_fits_stay_those_of_the_rest() -> None:
    recording = slow_log(40.0, 61, seconds=30.0, more=lambda q, v: 0.8 * q)
    motion = join_motions([read_motion(recording)])
    base = fit_held_out(write_plain_model([recording], motion), motion)
    fits, named = [base], [add_drag(base, motion)]  # there is none
    fits.append(fit_held_out(named[0].model, motion, named[0].held))
    named.append(add_spring(fits[-1], motion))
    fits.append(fit_held_out(named[1].model, motion, named[1].held))
    kept, names = _leave_out_needless(fits, named, motion, COULOMB)
    assert [one.name for one in names] == ["spring_torque"]
    ((one, before, after),) = Found(0.0, tuple(kept), tuple(names)).steps
    assert before is base
    assert {term.name for term in after.model.law.terms} == {"coulomb", "viscous", one.name}


def test_faster_recordings_are_left_to_the_rows() -> None:
    slow = slow_log(50.0, 61, seconds=5.0)
    fast = Recording(slow.time / 2.0, slow.position, slow.torque)
    assert is_low_rate([slow])
    assert is_low_rate([fast, slow])
    assert not is_low_rate([fast])


def test_nothing_is_named_where_readings_come_more_slowly_than_rows() -> None:
    log, rng = slow_log(40.0, 71, seconds=60.0), np.random.default_rng(72)
    late = np.maximum.accumulate(np.arange(len(log)) - (rng.random(len(log)) < 0.3))
    record = diagnose(log.with_channels(position=np.asarray(log.position)[np.maximum(late, 0)])).record
    assert not record.effects
    assert any("repeat the position of the one before" in sentence for sentence in record.sentences)


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, 0.2])
def test_the_slow_motion_of_a_fast_recording_gives_a_hint(load: float) -> None:
    log = slow_log(500.0, 91, gravity=3.0, load=load)
    told = describe_slow_motion(Given((log,), ("fast",), loops=(None,)))
    assert [("load_coulomb" in one, "no name" in one) for one in told] == ([(True, True)] if load else [])
