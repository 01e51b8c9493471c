"""A joint whose torque is recorded too large: links, friction and rotor are told, and written, in true torque."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.api.examine_arm import examine_arm
from fricomp.arm import ArmExamination
from fricomp.arm import examine_arm as examine_recordings
from fricomp.arm.comparison.torque_scale import scale_quantity
from fricomp.diagnosis.record.result import Quantity
from fricomp.model import load_model
from fricomp.simulation_file import read_specification

from .moving_arm import record_arm, write_arm

ROTORS = (0.1, 0.05, 0.0)
SCALE = 1.3


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scaled") / "out"


@pytest.fixture(scope="module")
def found(out: Path) -> ArmExamination:
    """The elbow has 0.8 N·m and 0.4 N·m·s/rad, as its simulation states."""
    plain = write_arm(out.parent, rotors=ROTORS)
    simulation = out.parent / "stated.xml"
    simulation.write_text(plain.read_text().replace('name="elbow"', 'name="elbow" frictionloss="0.8" damping="0.4"'))
    recordings = record_arm(plain)
    recordings[1] = recordings[1].with_channels(torque=SCALE * np.asarray(recordings[1].torque))
    return examine_arm(recordings, simulation, out=out)


@pytest.mark.slow
def test_friction_and_rotor_of_a_joint_with_a_wrong_scale_are_those_of_true_torque(found: ArmExamination) -> None:
    elbow = found.record.joints[1]
    (effect,) = elbow.effects
    assert effect.name == "torque_gain_error"
    assert effect.parameters["gain_error"].value == pytest.approx(SCALE - 1.0, abs=0.02)
    for name, truth in {"coulomb": 0.8, "viscous": 0.4}.items():
        low, high = elbow.friction[name].ci95
        assert low <= truth <= high
        assert elbow.friction[name].value == pytest.approx(truth, rel=0.05)
    assert elbow.rotor_inertia.value == pytest.approx(0.05, abs=0.01)
    assert not any("states other numbers" in line for line in found.record.sentences)
    assert any("divided" in line for line in found.record.summary)


@pytest.mark.slow
def test_the_files_of_a_joint_with_a_wrong_scale_hold_true_torque(found: ArmExamination, out: Path) -> None:
    curve = load_model(out / "joints" / "elbow" / "friction.json").law
    assert float(curve.torque(1.0)) == pytest.approx(1.2, rel=0.05)
    spec = read_specification(out / "arm.xml")
    assert spec.joint("elbow").armature == pytest.approx(0.05, abs=0.01)
    for joint in found.record.joints:
        assert joint.files is not None
        assert joint.files.torque < 1.2 * joint.files.torque_fit


def test_the_interval_of_what_is_divided_holds_what_the_factor_is_unknown_by() -> None:
    told = scale_quantity(Quantity(2.5, "N·m", (2.4, 2.6)), (1.25, 0.02))
    assert told.value == pytest.approx(2.0)
    half = np.hypot(0.08, 1.96 * 2.0 * 0.02 / 1.25)
    assert told.ci95 == pytest.approx((2.0 - half, 2.0 + half))
    assert scale_quantity(told, (1.0, 0.0)) is told


@pytest.mark.slow
def test_encoder_steps_in_a_band_that_is_too_wide_are_no_gear_that_gives_way(tmp_path: Path) -> None:
    """The band was chosen while the scale of the elbow was most of what was left."""
    simulation = write_arm(tmp_path, rotors=ROTORS)
    recordings = record_arm(simulation, noise=0.1, seed=1)
    recordings[1] = recordings[1].with_channels(torque=SCALE * np.asarray(recordings[1].torque))
    record = examine_recordings(recordings, simulation).record
    assert [[one.name for one in joint.effects] for joint in record.joints] == [[], ["torque_gain_error"], []]
    assert record.cutoff < 20.0
