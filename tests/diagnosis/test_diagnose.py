"""From a recording to a verdict: names, nulls, held-out gain and the extended model, on a joint of known truth."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.diagnosis import RigidJoint, diagnose
from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.preparation import prepare
from fricomp.diagnosis.search.refit import fit_from
from fricomp.diagnosis.search.simulated_body import hold
from fricomp.model import decode_model, encode_model

from .toy_joint import ToyJoint, recording

pytestmark = pytest.mark.slow


def test_nothing_is_named_where_nothing_is_missing() -> None:
    diagnosis = diagnose(recording(ToyJoint(), "fourier", 20.0, every=2))
    assert diagnosis.verdict == "consistent", diagnosis.sentences
    assert diagnosis.record.noise_ratio == pytest.approx(1.0, abs=0.12)


def test_friction_holds_the_constant_torque_and_intervals_hold_the_truth() -> None:
    joint = ToyJoint(offset=0.4)
    diagnosis = diagnose(recording(joint, "fourier", 20.0, every=2))
    model, base = diagnosis.base_model, diagnosis.record.base
    assert model is not None
    # Levels in steady sliding, which is where the rigid body leaves the constant torque to the friction.
    for speed, truth in ((0.8, joint.forward), (-0.8, joint.reverse)):
        wanted = (1.0 if speed > 0.0 else -1.0) * (truth[0] + truth[3] * abs(speed)) + joint.offset
        assert float(model.torque(speed)) == pytest.approx(wanted, abs=0.03)
    truths = (("offset", joint.offset), ("forward.coulomb_torque", 2.0), ("reverse.coulomb_torque", 2.3))
    for name, value in truths:
        low, high = base[name].ci95
        assert low <= value <= high, name
    assert "in the forward curve" in model.provenance.notes["torque_offset"]


def test_a_torque_in_amperes_is_not_compared_with_newton_metres() -> None:
    joint = ToyJoint()
    measured = recording(joint, "fourier", 20.0, every=2)
    amperes = replace(measured, torque=measured.torque / 2.0, metadata=replace(measured.metadata, torque_unit="A"))
    given = RigidJoint(joint.inertia, (1.773, 5.732), 0.0, 0.0, 0.0, True)
    diagnosis = diagnose(amperes, given)
    assert diagnosis.verdict == "consistent", diagnosis.sentences
    assert any("not compared" in line for line in diagnosis.record.summary)
    assert diagnosis.record.base["inertia"].unit == "A·s²/rad"


def test_torque_of_the_motor_side_is_not_explained_by_physics() -> None:
    joint = ToyJoint()
    joint_side = recording(joint, "fourier", 20.0, every=2)
    given = RigidJoint(joint.inertia, (1.773, 5.732), 0.0, 0.0, 0.0, True)
    diagnosis = diagnose(replace(joint_side, torque=joint_side.torque / 100.0), given)
    assert diagnosis.verdict == "bad_data"
    assert diagnosis.effects == ()
    assert "inertia" in diagnosis.sentences[-1]


def test_quadratic_drag_is_named_measured_and_added() -> None:
    joint = ToyJoint(quadratic_drag=0.4)
    diagnosis = diagnose(recording(joint, "rich", 25.0, every=2))
    assert [effect.name for effect in diagnosis.effects] == ["quadratic_drag"]
    low, high = diagnosis.effects[0].parameters["coefficient"].ci95
    assert low - 0.02 < joint.quadratic_drag < high + 0.02
    held = diagnosis.heldout
    assert held is not None
    assert held.rmse_after < 1.3 * held.noise_floor
    assert held.ci95_reduction[0] > 0.1
    model = diagnosis.extended_model
    assert model is not None
    assert decode_model(encode_model(model)).law.parameters() == model.law.parameters()


def test_gravity_held_to_none_about_a_vertical_axis_lets_the_rest_be_fitted() -> None:
    joint = ToyJoint(gravity=0.0, quadratic_drag=0.6)
    given = RigidJoint(joint.inertia, (0.0, 0.0), 0.0, 0.0, 0.0, True)
    tracks = build_tracks([recording(joint, "fourier", 20.0, every=2)])
    baseline = prepare(tracks, observer=Observer(), nulls=8, seed=0, rigid=given)
    drag = Structure(baseline.structure.contexts, (Candidate("quadratic_drag", (("coefficient", 0.0),)),))
    (free,) = fit_from(baseline, [(drag, baseline.fit.theta)], baseline.box)
    (held,) = fit_from(baseline, [(drag, baseline.fit.theta)], hold(baseline.box, given))
    assert held.gain > 0.7 * free.gain
    assert held.values["quadratic_drag"]["coefficient"] == pytest.approx(joint.quadratic_drag, abs=0.05)


def test_a_wrong_inertia_is_a_parameter_and_no_physics() -> None:
    joint = ToyJoint()
    given = RigidJoint(0.7 * joint.inertia, (1.773, 5.732), 0.0, 0.0, 0.0, True)
    diagnosis = diagnose(recording(joint, "fourier", 20.0, every=2), given)
    assert diagnosis.verdict == "parameters"
    assert [effect.name for effect in diagnosis.effects] == ["inertia_error"]


def test_a_load_that_differs_between_recordings_and_from_the_simulation_is_one_effect() -> None:
    joint, heavier = ToyJoint(), ToyJoint(inertia=0.40, gravity=7.2)
    recordings = [recording(joint, "fourier", 20.0), recording(heavier, "fourier", 20.0, seed=3)]
    given = RigidJoint(0.9 * joint.inertia, (0.85 * 1.773, 0.85 * 5.732), 0.0, 0.0, 0.0, True)
    diagnosis = diagnose(recordings, given)
    assert diagnosis.verdict == "parameters"
    (effect,) = diagnosis.effects
    assert effect.name == "payload_error"
    truths = {"inertia_2": 0.05, "gravity_sin_2": 1.2 * 0.9553, "inertia_change": 0.035, "gravity_sin_change": 0.860}
    for name, value in truths.items():
        assert effect.parameters[name].value == pytest.approx(value, rel=0.02), name
    assert effect.parameters["inertia_2"].unit == "kg·m²"


def test_a_spring_that_stiffens_is_told_from_another_gravity_by_the_simulation() -> None:
    joint = ToyJoint(spring=(2.5, 0.15, 0.4))
    given = RigidJoint(joint.inertia, (1.773, 5.732), 0.0, 0.0, 0.0, True)
    diagnosis = diagnose(recording(joint, "rich", 30.0, every=2), given)
    assert [effect.name for effect in diagnosis.effects] == ["spring_torque"], diagnosis.sentences
    found = diagnosis.effects[0].parameters
    for name, truth in zip(("stiffness", "centre", "hardening"), joint.spring, strict=True):
        low, high = found[name].ci95
        assert low <= truth <= high, name
        assert high - low < 0.2 * abs(truth), name  # of a joint held to its simulation


def test_the_same_recording_gets_the_same_answer() -> None:
    data = recording(replace(ToyJoint(), cogging=(0.15, 40.0)), "fourier", 12.0, every=2)
    first, second = diagnose(data), diagnose(data)
    assert first.record == second.record
    assert first.effects[0].name == "cogging"
