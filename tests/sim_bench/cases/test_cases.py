"""Concealed cases: strength, truth, and what the files give away."""

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from fricomp.errors import DiagnosisError
from fricomp.model import load_model
from fricomp.recording import check_recording, read_recording
from fricomp.sim_bench.cases import (
    CATALOGUE,
    EFFECTS,
    OUTSIDE,
    Case,
    CaseSpec,
    generate,
    record_again,
    write_answer,
    write_case,
)
from fricomp.sim_bench.cases.dynamics import Motion
from fricomp.sim_bench.cases.refit import build_rows, compute_enr, compute_left_after_refit, find_intervals
from fricomp.sim_bench.cases.sensing import Sensed
from fricomp.sim_bench.cases.writing import choose_expected_verdict

_NAMES_OF_THE_CATALOGUE = [
    "load_coulomb",
    "load_stribeck",
    "load_quadratic",
    "position_coulomb",
    "cogging",
    "kinematic_error",
    "presliding_hysteresis",
    "frictional_lag",
    "dwell_stiction",
    "thermal_friction",
    "stribeck_shape",
    "power_law_viscous",
    "quadratic_drag",
    "joint_elasticity",
    "backlash",
    "inertia_error",
    "payload_error",
    "torque_gain_error",
    "torque_saturation",
    "torque_ripple",
    "velocity_filter_lag",
    "torque_delay",
    "encoder_eccentricity",
    "spring_torque",
    "torque_offset",
    "direction_asymmetry",
    "neighbour_coupling",
    "end_stop",
    "external_disturbance",
    "torque_sensor_hysteresis",
    "supply_sag",
    "drive_lag",
    "torque_constant_heating",
]


def _spec(*effects: str, **fields: object) -> CaseSpec:
    given = {"seed": 11, "effects": effects, "duration": 15.0, "strength": "1"} | fields
    return CaseSpec(**given)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def cogging() -> Case:
    return generate(_spec("cogging"))


def test_every_effect_of_the_catalogue_can_be_concealed() -> None:
    assert sorted(CATALOGUE) == sorted(_NAMES_OF_THE_CATALOGUE)


def test_at_least_eight_effects_are_outside_the_catalogue() -> None:
    assert len(OUTSIDE) >= 8
    assert not set(OUTSIDE) & set(_NAMES_OF_THE_CATALOGUE)


@pytest.mark.slow
@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_has_the_wanted_strength_or_its_limit(name: str) -> None:
    case = generate(_spec(name, seed=21))
    only, (_, high) = case.concealed[0], EFFECTS[name].typical(case.scene)
    # A limited rate acts only where it is reached, so its strength jumps over the wanted one as the limit tightens.
    tolerance = 0.25 if name == "torque_rate_limit" else 0.06
    reached = abs(np.log(only.enr)) < tolerance
    weakest = only.amplitude < 1.05 * EFFECTS[name].floor(case.scene)
    assert reached or weakest or (only.enr < 1.0 and only.amplitude > 0.99 * high)
    assert case.enr == pytest.approx(only.enr, rel=1e-9)


@pytest.mark.slow
def test_the_same_spec_makes_the_same_case(cogging: Case) -> None:
    again = generate(cogging.spec)
    assert np.array_equal(again.outcome.sensed.torque, cogging.outcome.sensed.torque)
    assert again.concealed[0].amplitude == cogging.concealed[0].amplitude


def test_another_seed_makes_another_joint(cogging: Case) -> None:
    other = generate(replace(cogging.spec, seed=12, effects=()))
    assert other.scene.joint.fields["inertia"] != cogging.scene.joint.fields["inertia"]


def test_the_null_conceals_nothing() -> None:
    case = generate(_spec())
    assert case.enr < 1e-9
    assert choose_expected_verdict(case) == "consistent"


def test_hard_nulls_have_parameters_off_and_nothing_else() -> None:
    case = generate(_spec(shifted=True))
    assert case.enr < 1e-9
    assert choose_expected_verdict(case) == "parameters"
    assert 0.07 < abs(case.belief["inertia"] / case.scene.joint.fields["inertia"] - 1.0) < 0.26


def test_noise_has_the_stated_size(cogging: Case) -> None:
    for kind in ("white", "coloured", "quantised"):
        case = generate(_spec(noise=kind, seed=3))
        assert np.std(case.outcome.sensed.torque_error) == pytest.approx(case.scene.joint.noise, rel=0.15)


def test_the_refit_takes_up_what_the_simulation_has(cogging: Case) -> None:
    motion, rows = cogging.outcome.motion, cogging.outcome.rows
    in_span = 0.3 * motion.acceleration + 2.0 * np.sin(motion.position) + 0.5 * motion.sense + 0.1 * motion.velocity
    assert compute_enr(compute_left_after_refit(in_span, rows, "refit")) < 1e-9
    assert compute_enr(compute_left_after_refit(in_span, rows, "nothing")) > 1.0


def test_what_is_concealed_besides_is_refitted_all_at_once(cogging: Case) -> None:
    position, rows = cogging.outcome.motion.position, cogging.outcome.rows
    others = [np.sin(7.0 * position), np.cos(7.0 * position)]
    both = others[0] + 0.5 * others[1]
    assert compute_enr(compute_left_after_refit(both, rows, "refit", others)) < 1e-9
    assert all(compute_enr(compute_left_after_refit(both, rows, "refit", [other])) > 1.0 for other in others)


@pytest.mark.parametrize("soft", ["joint_elasticity", "backlash"])
def test_a_gear_runs_unevenly_behind_a_spring_too(soft: str) -> None:
    """A gear that runs unevenly moves a resting end of the spring: its ripple is felt as a torque of its own."""
    alone, both = (
        generate(_spec(effects=effects, strength="5", seed=7)) for effects in ((soft,), (soft, "kinematic_error"))
    )
    ripple = both.concealed[1]
    assert ripple.enr > 4.0
    felt = both.outcome.torque[both.start :] - alone.outcome.torque[alone.start :]
    assert np.std(felt) > 0.3 * np.std(ripple.torque[both.start :])


def test_two_effects_that_set_one_spring_are_refused() -> None:
    with pytest.raises(DiagnosisError, match=r"same part of the joint .*stiffness"):
        generate(_spec(effects=("joint_elasticity", "backlash"), strength="1"))


def _within(intervals: list[tuple[float, float]], time: np.ndarray) -> np.ndarray:
    inside = np.zeros(time.size, dtype=bool)
    for start, end in intervals:
        inside |= (time >= start) & (time < end)
    return inside


def test_location_holds_the_energy_of_a_localised_effect() -> None:
    case = generate(_spec("external_disturbance", strength="clear"))
    inside = _within(case.intervals, 1e-3 * np.arange(case.outcome.torque.size))
    energy = case.outcome.torque**2
    assert 0.7 < energy[inside].sum() / energy.sum() <= 1.0
    assert inside.mean() < 0.3


def test_location_hangs_on_no_grid_of_rows() -> None:
    """What a lag leaves at a reversal is shorter than a row: the same recording without its first 10 ms."""
    case, later = generate(_spec("frictional_lag", strength="2")), 10
    motion, sensed = case.outcome.motion, case.outcome.sensed
    cut = Motion(*(values[later:] for values in motion)), Sensed(*(values[later:] for values in sensed))
    time = 1e-3 * (np.arange(motion.position.size) + 0.5)
    found = []
    for step in (1, 21):
        rows = build_rows(*cut, case.scene.joint, step)
        intervals = find_intervals(compute_left_after_refit(case.outcome.torque[later:], rows, "refit"), step)
        found.append(_within([(a + 1e-3 * later, b + 1e-3 * later) for a, b in intervals], time))
    inside = _within(case.intervals, time)
    overlap = [float(np.sum(inside & one) / np.sum(inside | one)) for one in found]
    assert overlap[0] > 0.95
    assert overlap[1] < 0.85  # rows alone know no better


def test_two_effects_are_both_there_and_separable() -> None:
    case = generate(_spec("cogging", "load_coulomb"))
    assert [each.effect.name for each in case.concealed] == ["cogging", "load_coulomb"]
    assert case.enr == pytest.approx(np.sqrt(2.0), rel=0.25)


def test_another_motion_keeps_joint_and_effect(cogging: Case) -> None:
    t = np.arange(0.0, 6.0, 1e-3)
    reference = np.stack([0.5 * (1.0 - np.cos(t)), 0.5 * np.sin(t)], axis=1)
    again = record_again(cogging, reference)
    assert again.concealed[0].amplitude == cogging.concealed[0].amplitude
    assert again.change.plant == cogging.change.plant
    assert again.outcome.motion.position.size == t.size


def test_a_second_recording_has_its_own_noise_and_the_same_stop() -> None:
    case = generate(_spec("end_stop", excitation="slow_reversals", noise="white"))
    t = np.arange(0.0, 12.0, 1e-3)
    reference = np.stack([0.3 * np.sin(t), 0.3 * np.cos(t) * np.clip(t, 0.0, 1.0)], axis=1)
    again = record_again(case, reference)
    assert again.change.plant == case.change.plant
    n = t.size
    first, second = case.outcome.sensed.torque_error[:n], again.outcome.sensed.torque_error[:n]
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.1


def test_written_files_are_what_the_library_reads(cogging: Case, tmp_path: Path) -> None:
    folder = write_case(cogging, tmp_path)
    recording = read_recording(folder / "recording.parquet")
    assert recording.metadata.gear_ratio == cogging.scene.joint.gear_ratio
    assert np.array_equal(recording.torque, cogging.outcome.sensed.torque)
    assert not [finding for finding in check_recording(recording) if finding.severity == "error"]


def test_the_simulation_is_the_joint_without_the_effect(cogging: Case, tmp_path: Path) -> None:
    folder = write_case(cogging, tmp_path)
    model = mujoco.MjModel.from_xml_path(str(folder / "joint.xml"))
    data = mujoco.MjData(model)
    fields = cogging.scene.joint.fields
    for q in (-1.0, 0.2, 1.3):
        data.qpos[0], data.qvel[0], data.qacc[0] = q, 0.7, 2.0
        mujoco.mj_inverse(model, data)
        expected = fields["inertia"] * 2.0 + fields["gravity"] * np.sin(q + fields["gravity_angle"])
        assert data.qfrc_inverse[0] == pytest.approx(expected, rel=1e-6)


def test_nothing_the_diagnosis_reads_tells_the_effect(cogging: Case, tmp_path: Path) -> None:
    folder = write_case(cogging, tmp_path / "cases")
    for path in folder.iterdir():
        assert b"cogging" not in path.read_bytes()
    assert "cogging" not in folder.name
    null = generate(replace(cogging.spec, effects=()))
    other = write_case(null, tmp_path / "nulls")
    assert (other / "joint.xml").read_text() == (folder / "joint.xml").read_text()
    assert (other / "loop.toml").read_text() == (folder / "loop.toml").read_text()


def test_another_form_is_compared_by_what_the_catalogue_comes_closest_with(tmp_path: Path) -> None:
    skewed = generate(_spec("cogging", form="skewed", excitation="sweep", family="harmonic"))
    answer = json.loads(write_answer(skewed, tmp_path)[0].read_text())["effects"][0]
    true, closest = answer["parameters"], answer["comparable"]
    ratio = np.hypot(closest["sine"]["value"], closest["cosine"]["value"]) / np.hypot(
        true["sine"]["value"], true["cosine"]["value"]
    )
    # The fundamental of sin(x + k sin x) is J_0(k) - J_2(k) = 0.822 for k = 0.7.
    assert ratio == pytest.approx(0.822, abs=0.02)
    sine = generate(_spec("cogging", form="sine", excitation="sweep", family="harmonic"))
    answer = json.loads(write_answer(sine, tmp_path)[0].read_text())["effects"][0]
    assert answer["comparable"] == answer["parameters"]


_COMPARED = {
    "inertia_error": {"inertia_change"},
    "payload_error": {"gravity_cos_change", "gravity_sin_change", "inertia_change"},
    "velocity_filter_lag": {"time_constant"},
    "encoder_eccentricity": {"sine", "cosine", "order"},
    "thermal_friction": {"viscous_slope", "coulomb_slope"},
    "torque_constant_heating": {"sensitivity", "time_constant"},
}


@pytest.mark.parametrize("name", _COMPARED)
def test_answers_have_the_names_that_a_diagnosis_prints(name: str, tmp_path: Path) -> None:
    form = {"form": "exponential"} if name == "thermal_friction" else {}
    case = generate(_spec(name, **form))
    answer = json.loads(write_answer(case, tmp_path)[0].read_text())["effects"][0]
    assert set(answer["comparable"]) == _COMPARED[name]


def test_a_payload_is_what_the_simulation_lacks() -> None:
    case = generate(_spec("payload_error"))
    given, fields = case.belief, case.scene.joint.fields
    truth = {name: one.value for name, one in case.change.parameters.items()}
    lacking = fields["gravity"] - given["gravity"]
    assert np.hypot(truth["gravity_cos_change"], truth["gravity_sin_change"]) == pytest.approx(lacking)
    assert truth["inertia_change"] == pytest.approx(fields["inertia"] - given["inertia"])
    angle = np.arctan2(truth["gravity_cos_change"], truth["gravity_sin_change"])
    assert angle == pytest.approx(fields["gravity_angle"])


def test_without_a_recorded_temperature_nothing_is_known_by_the_kelvin(tmp_path: Path) -> None:
    case = generate(_spec("thermal_friction", hidden=True, form="exponential"))
    assert not json.loads(write_answer(case, tmp_path)[0].read_text())["effects"][0]["comparable"]


def test_pushes_are_told_one_by_one_unless_two_run_into_each_other(tmp_path: Path) -> None:
    told = {seed: set(generate(_spec("external_disturbance", seed=seed)).change.parameters) for seed in range(4)}
    assert any(told.values())
    for names in told.values():
        count = len(names) // 3
        assert names == {f"{name}_{k + 1}" for name in ("start", "end", "torque") for k in range(count)}


def test_the_answer_is_sealed_by_a_salted_hash(cogging: Case, tmp_path: Path) -> None:
    first, digest = write_answer(cogging, tmp_path / "a")
    _, other = write_answer(cogging, tmp_path / "b")
    answer = json.loads(first.read_text())
    assert digest != other
    assert answer["effects"][0]["name"] == "cogging"
    assert answer["verdict"] == "missing_physics"
    assert len(answer["salt"]) == 32


def test_the_believed_friction_comes_along_where_it_is_what_is_wrong(tmp_path: Path) -> None:
    case = generate(_spec("direction_asymmetry"))
    model = load_model(write_case(case, tmp_path) / "friction.json")
    assert model.forward == model.reverse
    assert case.change.plant["coulomb_forward"] != case.change.plant["coulomb_reverse"]


def test_hidden_channels_are_not_logged(tmp_path: Path) -> None:
    case = generate(_spec("thermal_friction", hidden=True))
    recording = read_recording(write_case(case, tmp_path) / "recording.parquet")
    assert recording.temperature is None
    assert recording.load_torque is None


@pytest.mark.parametrize("fault", ["counter_wrap", "dropped_samples", "stuck_torque", "frozen_position"])
def test_a_signal_fault_changes_the_recording_and_asks_for_bad_data(fault: str, tmp_path: Path) -> None:
    case = generate(_spec(fault=fault))
    recording = read_recording(write_case(case, tmp_path) / "recording.parquet")
    assert choose_expected_verdict(case) == "bad_data"
    same = recording.time.size == case.outcome.sensed.torque.size
    assert not same or not (
        np.array_equal(recording.torque, case.outcome.sensed.torque)
        and np.array_equal(recording.position, case.outcome.sensed.position)
    )


@pytest.mark.parametrize(
    ("fields", "word"),
    [({"strength": "strong"}, "strength"), ({"excitation": "dance"}, "excitation"), ({"noise": "pink"}, "noise")],
)
def test_an_unknown_choice_is_named_with_the_valid_ones(fields: dict[str, str], word: str) -> None:
    with pytest.raises(DiagnosisError, match=f"unknown {word} .*valid are"):
        _spec(**fields)


def test_an_unknown_effect_is_named() -> None:
    with pytest.raises(DiagnosisError, match="unknown effect 'magic'"):
        _spec("magic")


def test_the_answer_says_which_friction_core_and_noise_it_was(tmp_path: Path) -> None:
    path, _ = write_answer(generate(_spec(core="gms", noise="coloured", family="harmonic")), tmp_path)
    joint = json.loads(path.read_text())["joint"]
    assert (joint["core"], joint["noise_kind"], joint["family"]) == ("gms", "coloured", "harmonic")


def test_joints_with_nothing_missing_warm_up_and_state_their_friction_every_other_time(tmp_path: Path) -> None:
    cases = [generate(CaseSpec(seed=seed, duration=5.0)) for seed in range(12)]
    warm = [np.ptp(case.temperature) > 0.3 for case in cases]
    stated = [(write_case(case, tmp_path) / "friction.json").exists() for case in cases]
    assert 3 <= sum(warm) <= 9
    assert 3 <= sum(stated) <= 9
