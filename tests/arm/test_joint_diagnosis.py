"""The diagnosis of one joint of an arm, as a joint alone has it."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.arm import examine_arm
from fricomp.arm.output.choice import prepare_files
from fricomp.arm.output.joint_diagnosis import diagnose_joints
from fricomp.diagnosis import Diagnosis
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm

STIFFNESS = 1.5


def pull(joint: int, q: FloatArray, v: FloatArray, _: FloatArray) -> FloatArray:
    return STIFFNESS * q if joint == 2 else np.zeros_like(v)


@pytest.fixture(scope="module")
def joints(tmp_path_factory: pytest.TempPathFactory) -> list[Diagnosis]:
    """An arm with a spring in its last joint."""
    simulation = write_arm(tmp_path_factory.mktemp("sprung"))
    found = examine_arm(record_arm(simulation, pull), simulation)
    return diagnose_joints(found, prepare_files(found.answer, simulation))


@pytest.mark.slow
def test_the_joint_with_the_spring_misses_it_and_the_others_nothing(joints: list[Diagnosis]) -> None:
    assert [one.verdict for one in joints][:2] == ["consistent", "consistent"]
    (effect,) = joints[2].effects
    assert (joints[2].verdict, effect.name) == ("missing_physics", "spring_torque")
    low, high = effect.parameters["stiffness"].ci95
    assert low - 0.02 < STIFFNESS < high + 0.02


def test_the_files_of_the_joint_hold_what_was_named(joints: list[Diagnosis]) -> None:
    """The spring is in arm.xml and in friction.json, and pulls once."""
    errors = joints[2].record.errors
    assert errors is not None
    assert errors.after is not None
    assert errors.after.torque.rms < 0.5 * errors.before.torque.rms
    assert errors.file.torque.rms < 0.5 * errors.before.torque.rms


def test_rows_before_and_after_show_where_it_sits(joints: list[Diagnosis]) -> None:
    (series,) = joints[2].evidence.series
    assert np.std(series.after) < 0.5 * np.std(series.before)
    assert joints[2].record.location
    assert "velocity" in joints[2].evidence.maps
    assert series.time.shape == series.load_torque.shape == series.time_since_reversal.shape


def test_what_was_tried_is_told_with_why_it_is_not_named(joints: list[Diagnosis]) -> None:
    first, *others = joints[2].record.rivals
    assert (first.effects, first.refused) == (("spring_torque",), "")
    assert all(one.refused for one in others)
    assert joints[2].record.probability["spring_torque"] >= 0.9
