"""Concealed arms: their dynamics are those of MuJoCo with friction that sticks, and their files give nothing away."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import DiagnosisError
from fricomp.recording import read_recording
from fricomp.sim_bench.cases.arm import (
    JOINTS,
    ArmCase,
    ArmSpec,
    arm_id,
    draw_spec,
    generate_arm,
    parse_effect,
    write_arm_answer,
    write_arm_case,
)
from fricomp.sim_bench.cases.arm.friction import FIELDS, compute_friction, solve_step
from fricomp.sim_bench.cases.arm.joints import draw_friction
from fricomp.sim_bench.cases.arm.links import build_true_arm, compute_torques
from fricomp.sim_bench.cases.arm.plant import _Plant


@pytest.fixture(scope="module")
def case() -> ArmCase:
    return generate_arm(ArmSpec(5, (("elbow", "load_coulomb"),), wrong_links=1, duration=6.0))


def test_recorded_torques_are_inverse_dynamics_with_friction(case: ArmCase) -> None:
    """Means over 0.04 s, in which no joint turns round, of the true arm's own equations."""
    rows = len(case.time) // 20

    def average(samples: np.ndarray) -> np.ndarray:
        return np.asarray(samples[: rows * 20].reshape(rows, 20, 6).mean(axis=1))

    q = np.stack([case.channels[name]["position"] for name in JOINTS], axis=1)
    v = np.gradient(q, case.time, axis=0)
    late = [np.interp(case.time + case.delay, case.time, case.channels[name]["torque"]) for name in JOINTS]
    position, velocity, torque = average(q), average(v), average(np.stack(late, axis=1))
    acceleration = np.gradient(velocity, 0.04, axis=0)
    rigid = compute_torques(case.model, position, velocity, acceleration)
    load = rigid - acceleration * case.model.dof_armature
    friction = compute_friction(case.table, position, velocity, load, np.zeros_like(position))
    slides = np.abs(velocity) > 0.3
    left = np.where(slides, torque - rigid - friction, 0.0)[50:-5]
    assert np.all(np.sqrt(np.mean(left**2, axis=0)) < 0.06 * case.table[:, FIELDS.index("coulomb_forward")])


def test_a_joint_below_its_friction_does_not_move_at_all() -> None:
    model, _ = build_true_arm(np.random.default_rng(1), 0)
    table = draw_friction(np.random.default_rng(2))
    plant = _Plant(model, table, np.array([0.0, 0.6, 0.7, 0.3, 0.0, 0.0]), None)
    plant.read_mass_matrix()
    still = plant.position.copy()
    for _ in range(200):
        plant._move(plant._bias + 0.9 * table[:, FIELDS.index("coulomb_forward")], np.zeros(6))
    assert np.array_equal(plant.position, still)
    plant._move(plant._bias + 2.0 * table[:, FIELDS.index("coulomb_forward")], np.zeros(6))
    assert np.all(plant.velocity > 0.0)


def test_the_step_solves_the_equations_of_motion() -> None:
    rng = np.random.default_rng(3)
    table, root = draw_friction(rng), rng.normal(size=(6, 6))
    M, v, force, h = root @ root.T + 2.0 * np.eye(6), rng.normal(size=6), 30.0 * rng.normal(size=6), 1e-3
    friction = np.zeros(6)
    new = solve_step(table, np.zeros(6), v, np.zeros(6), np.zeros(6), np.zeros(6), M, force, h, friction)
    assert M @ (new - v) == pytest.approx(h * (force - friction), abs=1e-7)


def test_the_same_spec_makes_the_same_arm(case: ArmCase) -> None:
    again = generate_arm(case.spec)
    assert np.array_equal(again.channels["wrist_3"]["torque"], case.channels["wrist_3"]["torque"])


def test_files_tell_nothing_and_the_answer_tells_all(case: ArmCase, tmp_path: Path) -> None:
    folder = write_arm_case(case, tmp_path / "arms")
    path, digest = write_arm_answer(case, tmp_path / "arms.answers")
    assert folder.name == arm_id(case.spec)
    assert len(digest) == 64
    text = "".join(one.read_text() for one in folder.rglob("*") if one.is_file())
    assert "load_coulomb" not in text
    assert "seed" not in text
    recording = read_recording(folder / "log" / "elbow.csv")
    assert recording.metadata.joint == "elbow"
    assert recording.temperature is not None
    answer = json.loads(path.read_text())
    assert [(one["joint"], one["name"]) for one in answer["effects"]] == [("elbow", "load_coulomb")]
    assert answer["effects"][0]["enr"] > 0.0
    assert answer["links"]["forearm"]["mass"] > 0.0


def test_arms_are_drawn_with_no_effect_one_or_two() -> None:
    specs = [draw_spec(seed) for seed in range(200)]
    counts = np.bincount([len(spec.effects) for spec in specs])
    assert counts.size == 3
    assert counts.min() > 20
    assert len({effect for spec in specs for _, effect in spec.effects}) == 12


def test_an_effect_without_its_joint_is_refused() -> None:
    assert parse_effect("elbow:cogging") == ("elbow", "cogging")
    with pytest.raises(DiagnosisError, match="JOINT:NAME"):
        parse_effect("cogging")
