"""Arms in motion with known links and friction: what is off is found where it is, and nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import ArmExamination, ArmRecord, build_friction_model, examine_arm
from fricomp.arm.columns import turn_bristle
from fricomp.errors import FricompError, RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .moving_arm import MASSES, Friction, record_arm, write_arm


def follow_load(joint: int, _: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    return 0.12 * np.abs(load) * np.sign(v) if joint == 0 else np.zeros_like(v)


def make_bristle(distance: float) -> Friction:
    """Presliding of the elbow over a breakaway distance [rad]."""

    def turn(joint: int, q: FloatArray, v: FloatArray, _: FloatArray) -> FloatArray:
        return 0.8 * (turn_bristle(q, distance) - np.sign(v)) if joint == 1 else np.zeros_like(v)

    return turn


def names_of(record: ArmRecord) -> dict[str, list[str]]:
    return {joint.name: [effect.name for effect in joint.effects] for joint in record.joints}


@pytest.fixture(scope="module")
def healthy(tmp_path_factory: pytest.TempPathFactory) -> ArmExamination:
    simulation = write_arm(tmp_path_factory.mktemp("healthy"))
    return examine_arm(record_arm(simulation, delay=0.004), simulation)


def test_nothing_is_named_in_a_healthy_arm(healthy: ArmExamination) -> None:
    assert names_of(healthy.record) == {"shoulder": [], "elbow": [], "wrist": []}
    assert [link.name for link in healthy.record.links if link.state == "off"] == []
    assert healthy.record.sentences[0].startswith("Nothing is missing")


def test_of_a_healthy_arm_hardly_anything_is_left(healthy: ArmExamination) -> None:
    assert max(joint.unexplained for joint in healthy.record.joints) < 0.03


def test_friction_of_every_joint_lies_within_its_interval(healthy: ArmExamination) -> None:
    for joint, level, slope in zip(healthy.record.joints, (1.2, 0.8, 0.3), (0.6, 0.4, 0.1), strict=True):
        for name, truth in (("coulomb", level), ("viscous", slope)):
            low, high = joint.friction[name].ci95
            assert low - 0.01 < truth < high + 0.01
            assert joint.friction[name].value == pytest.approx(truth, abs=0.05)


def test_a_delay_of_all_torques_is_found_once(healthy: ArmExamination) -> None:
    assert healthy.record.delay.value == pytest.approx(0.004, abs=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("stated", [(0.0, 0.0, 0.0), (0.02, 0.02, 0.02)], ids=["none", "wrong"])
def test_rotors_that_the_simulation_lacks_are_no_gain_of_all_torques_and_no_lighter_links(
    tmp_path: Path, stated: tuple[float, float, float]
) -> None:
    rotors = (5.0, 3.0, 0.8)  # behind gears, more than the links; a URDF has none, an MJCF often one number for all
    record = examine_arm(record_arm(write_arm(tmp_path, rotors=rotors)), write_arm(tmp_path, rotors=stated)).record
    assert record.gain is None
    assert [link.name for link in record.links if link.state == "off"] == []
    assert names_of(record) == {"shoulder": [], "elbow": [], "wrist": []}
    for joint, truth in zip(record.joints, rotors, strict=True):
        assert joint.rotor_inertia.value == pytest.approx(truth, rel=0.1)


def test_the_error_of_a_healthy_arm_is_its_noise(healthy: ArmExamination) -> None:
    """0.03 N·m of white noise through a low-pass leaves less than that, and the model leaves no more."""
    assert all(joint.error_model < 0.03 for joint in healthy.record.joints)


def test_a_heavier_link_is_found_with_its_mass(tmp_path: Path) -> None:
    simulation, truth = write_arm(tmp_path), (MASSES[0], MASSES[1], MASSES[2] + 1.5)
    record = examine_arm(record_arm(write_arm(tmp_path, truth)), simulation).record
    hand = record.links[2]
    assert hand.state == "off"
    assert hand.mass.ci95[0] < truth[2] + 0.05 < hand.mass.ci95[1]
    assert hand.mass.value == pytest.approx(truth[2] + 0.05, rel=0.05)
    assert names_of(record) == {"shoulder": [], "elbow": [], "wrist": []}


def test_friction_that_follows_the_load_is_named_in_its_joint(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    record = examine_arm(record_arm(simulation, follow_load), simulation).record
    assert names_of(record) == {"shoulder": ["load_coulomb"], "elbow": [], "wrist": []}
    coefficient = record.joints[0].effects[0].parameters["coefficient"]
    assert coefficient.value == pytest.approx(0.12, abs=0.01)
    assert record.joints[0].error_model < 0.5 * record.joints[0].error_plain


@pytest.mark.slow
@pytest.mark.parametrize("distance", [0.008, 0.0105])
def test_presliding_is_named_in_its_joint(distance: float, tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    found = examine_arm(record_arm(simulation, make_bristle(distance)), simulation)
    assert names_of(found.record) == {"shoulder": [], "elbow": ["presliding_hysteresis"], "wrist": []}
    assert found.record.joints[1].effects[0].parameters["breakaway_distance"].value == pytest.approx(distance, rel=0.2)
    assert build_friction_model(found.answer.identification, 1).law.is_dynamic


def test_gaps_are_left_out_and_told(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    torn = [one.rows(np.flatnonzero((one.time < 15.0) | (one.time > 19.0))) for one in record_arm(simulation)]
    record = examine_arm(torn, simulation).record
    assert record.left_out == pytest.approx(0.1, abs=0.01)
    assert names_of(record) == {"shoulder": [], "elbow": [], "wrist": []}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda series: series[:1], "two joints or more"),
        (lambda series: [series[0], series[0]], "comes twice"),
        (lambda series: [series[0], series[1].with_metadata(torque_unit="A")], "torque constant"),
        (lambda series: [series[0], series[1].with_channels(time=np.asarray(series[1].time) + 100.0)], "share 0 s"),
    ],
)
def test_what_is_no_arm_is_refused(tmp_path: Path, change, message: str) -> None:  # type: ignore[no-untyped-def]
    simulation = write_arm(tmp_path)
    series: list[Recording] = record_arm(simulation, duration=5.0)
    with pytest.raises((RecordingError, FricompError), match=message):
        examine_arm(change(series), simulation)


def test_a_gear_that_gives_way_has_a_stiffness_where_the_motor_has_an_encoder(tmp_path: Path) -> None:
    """The motor of the elbow stands ahead of its joint by what the gear transmits over 3000 N·m/rad."""
    simulation = write_arm(tmp_path)
    series = record_arm(simulation)
    load = np.asarray(series[1].torque) - 0.8 * np.sign(np.gradient(series[1].position)) - 0.0
    series[1] = series[1].with_channels(motor_position=np.asarray(series[1].position) + load / 3000.0 + 0.2)
    record = examine_arm(series, simulation).record
    assert [joint.stiffness is None for joint in record.joints] == [True, False, True]
    stiffness = record.joints[1].stiffness
    assert stiffness is not None
    assert stiffness.value == pytest.approx(3000.0, rel=0.05)
    assert any(line.startswith("The gear of elbow gives way") for line in record.sentences)
