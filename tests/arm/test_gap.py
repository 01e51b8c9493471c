"""Gaps in the gears of an arm: links that move otherwise than their motor, in all joints at once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from fricomp import examine_arm as examine_log
from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.answer import _measure_fall
from fricomp.arm.confirmation import ConfirmedData, HeldOutErrors
from fricomp.arm.coordinates import ArmModel, Coordinates
from fricomp.arm.equations import build_equations
from fricomp.arm.examination import match_recordings
from fricomp.arm.fit import ArmFit
from fricomp.arm.friction import PLAIN, JointForm
from fricomp.arm.log import read_arm_log
from fricomp.arm.physics import is_physical
from fricomp.arm.prior import ArmPrior
from fricomp.arm.robust_fit import fit_robustly
from fricomp.arm.rows import ArmRows, build_rows
from fricomp.arm.search.gear import GearSearch
from fricomp.arm.search.gear_motion import Gear, GearMotion
from fricomp.arm.squares import WeightedSquares
from fricomp.arm.timing.gear_band import find_gaps
from fricomp.laws import FloatArray
from fricomp.sim_bench.cases.arm import ArmSpec, generate_arm, write_arm_case

from .moving_arm import record_arm, write_arm
from .test_examination import names_of


@pytest.fixture(scope="module")
def healthy(tmp_path_factory: pytest.TempPathFactory) -> ArmExamination:
    simulation = write_arm(tmp_path_factory.mktemp("healthy"))
    return examine_arm(record_arm(simulation, duration=20.0), simulation)


def test_no_gap_is_found_where_none_is(healthy: ArmExamination) -> None:
    assert names_of(healthy.record) == {"shoulder": [], "elbow": [], "wrist": []}
    assert all("backlash" not in form.names for form in healthy.answer.identification.fit.model.forms)


def test_a_gap_acts_in_all_joints_by_one_parameter(healthy: ArmExamination) -> None:
    found = healthy.answer.identification
    arm, equations, n = found.fit.arm, found.equations, len(found.rows)
    rng = np.random.default_rng(0)
    torques = rng.normal(size=(n, 3, 3))
    equations = equations.with_gears("gap", np.tile([1e-3, 1e4, 10.0], (3, 1)), torques)
    model = ArmModel((JointForm((("backlash", 0),)), JointForm(), JointForm((("backlash", 0),))))
    coordinates = Coordinates(arm, model)
    x = coordinates.take_over(found.fit.model, found.fit.x, np.zeros(coordinates.size))
    fit = replace(found.fit, model=model, x=x)
    for joint in (0, 2):
        at = fit.find_friction(joint)[0].start + len(PLAIN)
        moved = replace(fit, x=x + np.eye(x.size)[at])
        change = fit.residuals(equations) - moved.residuals(equations)
        assert change == pytest.approx(torques[:, :, joint])


def test_slopes_of_gaps_are_those_of_the_squares(healthy: ArmExamination) -> None:
    found = healthy.answer.identification
    torques = np.random.default_rng(1).normal(size=(len(found.rows), 3, 3))
    equations = found.equations.with_gears("gap", np.tile([1e-3, 1e4, 10.0], (3, 1)), torques)
    model = ArmModel(tuple(JointForm((("backlash", 0),)) for _ in range(3)))
    coordinates = Coordinates(found.fit.arm, model)
    x = coordinates.take_over(found.fit.model, found.fit.x, np.zeros(coordinates.size))
    squares = WeightedSquares(coordinates, equations)
    seen = squares.linearise(x)
    for place in coordinates.places:
        step = np.zeros_like(x)
        step[place.stop - 1] = 1e-3
        there, back = (squares.measure(x + sign * step) for sign in (1.0, -1.0))
        assert seen.pull[place.stop - 1] == pytest.approx(-(there - back) / 4e-3, rel=1e-5)
        assert seen.curvature[place.stop - 1, place.stop - 1] == pytest.approx(
            (there + back - 2.0 * seen.cost) / 2e-6, rel=1e-4
        )


def test_what_could_not_exist_before_speaks_against_no_term(healthy: ArmExamination) -> None:
    fit = healthy.answer.identification.fit
    x = fit.x.copy()
    x[fit.find_friction(1)[0].start + PLAIN.index("coulomb")] = -5.0
    below = replace(fit, x=x)
    assert is_physical(fit)
    assert not is_physical(below)
    assert not is_physical(below, fit)
    assert is_physical(below, below)


def test_a_gap_matters_by_the_rows_that_count_and_what_has_a_factor_by_all(healthy: ArmExamination) -> None:
    """It acts where the load turns; what no model holds about the joint's own reversals is most of the error there."""

    class Held(ConfirmedData):
        def measure_model(self, model: ArmModel, start: ArmFit) -> tuple[FloatArray, FloatArray, FloatArray]:
            return np.full(3, 1.0), np.full((2, 3), 1.0), np.full(3, 0.5)

    found, ones = healthy.answer.identification, np.ones(3)
    data = Held(found.fit.arm, found.equations, found.prior, found.rows)
    errors = HeldOutErrors(
        simulation=ones, plain=ones, model=0.98 * ones, means=np.full((2, 3), 0.97), weighted=0.3 * ones, lasting=ones
    )
    for name, fall in (("backlash", 0.4), ("spring_torque", 0.03)):
        forms = (JointForm(((name, 0),)), JointForm(), JointForm())
        fit = replace(found.fit, model=ArmModel(forms))
        assert _measure_fall(data, fit, errors, (0, name)) == pytest.approx(fall)


@pytest.mark.slow
def test_a_gap_is_named_with_its_width(tmp_path: Path) -> None:
    """The arm is simulated by code that shares nothing with its examination."""
    case = generate_arm(ArmSpec(seed=11, effects=(("elbow", "backlash"),), wrong_links=1, duration=40.0))
    folder = write_arm_case(case, tmp_path)
    record = examine_log(folder / "log", folder / "arm.xml").record
    assert b'"backlash"' in msgspec.json.encode(record)  # plain numbers, which the file can hold
    (truth,) = case.effects
    assert truth.enr > 0.5
    assert [name for names in names_of(record).values() for name in names] == ["backlash"]
    (effect,) = next(joint.effects for joint in record.joints if joint.name == "elbow")
    assert effect.parameters["gap"].value == pytest.approx(truth.change.truth["gap"], rel=0.1)


@pytest.mark.slow
def test_a_gear_that_gives_way_in_a_narrow_band_is_a_gap_in_a_wider_one(tmp_path: Path) -> None:
    case = generate_arm(ArmSpec(seed=11, effects=(("elbow", "backlash"),), wrong_links=0, duration=25.0))
    folder, prior = write_arm_case(case, tmp_path), ArmPrior()
    (log,) = read_arm_log([folder / "log"], simulation=folder / "arm.xml").sessions
    arm, recording = match_recordings(log, folder / "arm.xml")
    rows, elbow = build_rows(arm, recording, 2.5), arm.joints.index("elbow")
    plain = ArmModel.build_plain(6)
    bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel())
    rigid, equations = fit_robustly(arm, rows, bare, plain, prior)
    assert find_gaps(rows, equations, rigid, recording, prior) is None
    gear = np.zeros((6, 3))
    gear[elbow] = 0.0, choose_stiffness(rows, rigid, elbow), 0.1
    equations = GearSearch(GearMotion(rows, rigid), "spring").build(equations, gear)
    forms = (*plain.forms[:elbow], JointForm((("joint_elasticity", 0),)), *plain.forms[elbow + 1 :])
    yielding, equations = fit_robustly(arm, rows, equations, ArmModel(forms), prior, rigid)
    gaps = find_gaps(rows, equations, yielding, recording, prior)
    assert gaps is not None
    assert gaps.rows.cutoff > 2.5
    assert gaps.fit.model.forms[elbow].names == ("backlash",)
    assert gaps.equations.gears["gap"][elbow, 0] == pytest.approx(case.effects[0].change.truth["gap"], rel=0.15)


def choose_stiffness(rows: ArmRows, fit: ArmFit, joint: int) -> float:
    """Of teeth on which the load of a joint swings at 10 Hz [N·m/rad]."""
    return float(GearMotion(rows, fit).inertia[joint] * (2.0 * np.pi * 10.0) ** 2)


def test_a_gear_that_cannot_be_simulated_explains_nothing(healthy: ArmExamination) -> None:
    """At ten times its critical damping the steps of the simulation grow without end, which was an overflow."""
    found = healthy.answer.identification
    motion = GearMotion(found.rows, found.fit)
    inertia = 0.5
    stiff, damped = Gear(1e-3, inertia * 240.0**2, 20.0 * inertia * 240.0), Gear(1e-3, inertia * 240.0**2, 20.0)
    assert np.all(motion.spread(0, stiff, "gap") == 0.0)
    assert np.any(motion.spread(0, damped, "gap") != 0.0)
