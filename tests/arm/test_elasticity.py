"""Gears of an arm that give way, beside the motors' positions: their stiffness is told, and of links nothing false."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.arm import ArmRecord, examination, examine_arm
from fricomp.arm.examination import match_recordings
from fricomp.arm.identification import ArmIdentification, identify_arm, identify_without
from fricomp.arm.output.choice import prepare_files
from fricomp.arm.rigid.regressor import compute_gradients, compute_regressor
from fricomp.arm.search.gear import swings
from fricomp.arm.search.gear_motion import Gear

from .moving_arm import bend_gear, record_arm, write_arm
from .swinging_arm import record_swinging
from .test_examination import follow_load, names_of

_ELBOW = 1
_GEAR = {"shoulder": [], "elbow": ["joint_elasticity"], "wrist": []}


def _examine(folder: Path, stiffness: float, side: str, seed: int = 0) -> ArmRecord:
    simulation = write_arm(folder)
    bend = bend_gear(_ELBOW, stiffness=stiffness, side=side)
    return examine_arm(record_arm(simulation, duration=30.0, bend=bend, seed=seed), simulation).record


@pytest.mark.parametrize(("stiffness", "seed"), [(120.0, 0), (400.0, 0), (400.0, 1), (120.0, 2), (120.0, 3)])
def test_the_stiffness_of_a_gear_behind_the_encoder_is_told(tmp_path: Path, stiffness: float, seed: int) -> None:
    """Links were off in its place, without a word about the gear, or the shoulder had a spring, a ripple, or the gear:
    it feels how fast the elbow's link turns beside its motor."""
    record = _examine(tmp_path, stiffness, "motor", seed)
    assert names_of(record) == _GEAR
    (effect,) = record.joints[_ELBOW].effects
    assert effect.parameters["stiffness"].value == pytest.approx(stiffness, rel=0.1)
    assert effect.parameters["stiffness"].unit == "N·m/rad"
    off = [link for link in record.links if link.state == "off"]
    assert all(link.mass.value == pytest.approx(link.simulated_mass, rel=0.03) for link in off)


@pytest.mark.parametrize("stiffness", [300.0, 500.0])
def test_the_stiffness_of_a_gear_on_which_the_load_swings_on_is_told(tmp_path: Path, stiffness: float) -> None:
    """Whatever it is: between two that the search began from it was told a third too small, or a wrist had a spring."""
    simulation = write_arm(tmp_path)
    record = examine_arm(record_swinging(simulation, stiffness, duration=20.0), simulation).record
    assert names_of(record) == _GEAR
    (effect,) = record.joints[_ELBOW].effects
    told = effect.parameters["stiffness"]
    assert told.value == pytest.approx(stiffness, rel=0.05)  # over the factor on the swing, a tenth off
    assert told.ci95[0] <= told.value <= told.ci95[1]


def test_files_of_an_elastic_arm_go_less_wrong_than_its_simulation(tmp_path: Path) -> None:
    """No file holds the gear: right links beside none of it went wrong by as much as the simulation."""
    simulation = write_arm(tmp_path)
    bend = bend_gear(_ELBOW, stiffness=400.0, side="motor")
    found = examine_arm(record_arm(simulation, duration=30.0, bend=bend, seed=1), simulation)
    written = prepare_files(found.answer, simulation)
    for joint in ("shoulder", "elbow"):
        assert written.errors[joint].torque < 0.6 * written.errors[joint].torque_simulation
    assert any("no gear that gives way" in note for note in written.notes)


@pytest.mark.parametrize(("stiffness", "side"), [(400.0, "link"), (1e5, "motor")])
def test_no_gear_is_told_where_none_shows(tmp_path: Path, stiffness: float, side: str) -> None:
    """The encoder is on the side of the link, or the gear bends by less than the encoder's step."""
    named = names_of(_examine(tmp_path, stiffness, side))
    assert not any("joint_elasticity" in names for names in named.values())


@pytest.mark.parametrize(
    ("rate", "ratio", "is_gear"), [(30.0, 0.1, True), (30.0, 0.9, True), (30.0, 1.1, False), (7.9, 0.1, False)]
)
def test_what_does_not_swing_is_no_gear_that_gives_way(rate: float, ratio: float, *, is_gear: bool) -> None:
    """Joint 1 of a UR10e had one on which its load would have swung at 1.3 Hz, damped by twice the critical."""
    inertia = 4.8
    gear = Gear(0.0, inertia * rate**2, 2.0 * ratio * inertia * rate)
    assert swings(gear, inertia) is is_gear


def test_gradients_are_those_of_the_torque(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    arm, _ = match_recordings(record_arm(simulation, duration=5.0, rate=100.0), simulation)
    q, v, a = np.random.default_rng(0).normal(size=(3, 4, 3))
    by_position, by_velocity = compute_gradients(arm, q, v, a, arm.inertia)
    step = 1e-5 * np.eye(3)[_ELBOW]
    there, back = (compute_regressor(arm, q + way * step, v, a) @ arm.inertia.ravel() for way in (1.0, -1.0))
    assert by_position[:, :, _ELBOW] == pytest.approx((there - back) / 2e-5, abs=1e-5)
    there, back = (compute_regressor(arm, q, v + way * step, a) @ arm.inertia.ravel() for way in (1.0, -1.0))
    assert by_velocity[:, :, _ELBOW] == pytest.approx((there - back) / 2e-5, abs=1e-5)


def test_a_gear_that_is_not_borne_out_is_barred_and_all_is_searched_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulation = write_arm(tmp_path)
    recordings = record_arm(simulation, follow_load, duration=10.0, rate=100.0)
    begun: list[tuple[ArmIdentification, frozenset[str]]] = []
    gears: list[frozenset[str]] = [frozenset({"a: joint_elasticity"}), frozenset()]

    def look(found: ArmIdentification, barred: frozenset[str], *_: Any) -> ArmIdentification:
        begun.append((found, barred))
        return identify_without(found, barred)

    monkeypatch.setattr(examination, "identify_without", look)
    monkeypatch.setattr(examination, "_list_gears", lambda _: gears.pop(0))
    found = examination.examine_arm(recordings, simulation).answer.identification
    ((first, barred),) = begun
    assert barred == {"a: joint_elasticity"}
    assert [form.names for form in first.fit.model.forms] == [form.names for form in found.fit.model.forms]


def test_what_is_barred_is_not_taken_in(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    recordings = record_arm(simulation, follow_load, duration=10.0, rate=100.0)
    found = identify_arm(*examination.match_recordings(recordings, simulation))
    joint = next(j for j, form in enumerate(found.fit.model.forms) if "load_coulomb" in form.names)
    less = replace(found, fit=replace(found.fit, model=found.fit.model.without_terms(joint, "load_coulomb")))
    names = {barred: _search_on(less, barred=barred).fit.model.forms[joint].names for barred in (False, True)}
    assert "load_coulomb" in names[False]
    assert "load_coulomb" not in names[True]


def _search_on(found: ArmIdentification, *, barred: bool) -> ArmIdentification:
    names = {f"{joint}: load_coulomb" for joint in found.fit.arm.joints} if barred else set()
    return identify_without(found, frozenset(names))
