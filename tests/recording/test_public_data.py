"""Every public set through its mapping: samples, units and facts that its authors published."""

from functools import cache

import numpy as np
import pytest

from fricomp.api.identify import identify
from fricomp.errors import RecordingError
from fricomp.recording import (
    NamedRecording,
    Recording,
    check_recording,
    find_public_data,
    list_mappings,
    read_public,
    read_public_named,
)
from fricomp.recording.checks.motion_kind import fit_clamp
from fricomp.recording.checks.torque_sensor import fit_two_torques
from fricomp.recording.parts.parts import find_usable_parts

_TURN = 2 * np.pi

SAMPLES = {
    "am-d02-arm": {"joint_1": 3146},
    "cycloid-anti-backlash": {
        "split_init": 6062,
        "split_runin": 6756,
        "split_preload1": 6565,
        "split_preload2": 6328,
        "split_preload3": 6443,
        "baseline_reamed": 6577,
    },
    "damiao-joints": {"motor_1": 4153, "motor_3": 3424, "motor_5": 2475},
    "kinova-gen3-short": {**{f"together/joint_{k}": 1942 for k in range(1, 8)}, "alone": 6127},
    "maxon-drive-lag": {"pulses": 9750, "random": 10910},
    "moteus-dynamometer": {"stall": 3867, "idle": 4160, "cogging_1": 10050, "cogging_2": 10050},
    "pendulum-gravity-hand": {"hand": 30000, "swing_up": 3000},
    "pneumatic-cylinder": {
        "napn_1bar": 7032,
        "napn_3bar": 8021,
        "napn_5bar": 10189,
        "napn_7bar": 8488,
        "o_ring257_1bar": 5828,
        "o_ring257_3bar": 6340,
        "o_ring257_5bar": 7090,
        "o_ring257_7bar": 8557,
    },
    "anymal-sea": {"walk": 2273},
    "bam-xl330": {
        "kp100_sin_sin": 1124,
        "kp100_lift_and_drop": 372,
        "kp100_lift_and_drop_free": 1138,
        "kp100_up_and_down": 1116,
        "kp100_sin_time_square": 1116,
        "kp200_sin_sin": 1116,
        "kp200_lift_and_drop": 375,
        "kp200_lift_and_drop_free": 1138,
        "kp200_up_and_down": 1120,
        "kp200_sin_time_square": 1110,
        "kp800_sin_sin": 1117,
        "kp800_lift_and_drop": 376,
        "kp800_lift_and_drop_free": 1133,
        "kp800_up_and_down": 1113,
        "kp800_sin_time_square": 1110,
    },
    "brfd-backlash": {
        "1hz_20lb": 10241,
        "1hz_35lb": 10241,
        "1hz_80lb": 10241,
        "1hz_30lb": 7169,
        "1hz_36lb": 7169,
        "2hz_36lb": 3585,
        "imperial_valley": 28698,
        "kocaeli": 27342,
    },
    "daisy-flexible-arm": {"sweep": 1024},
    "emps": {"train": 24841, "pulses": 24841},
    "laas-cogging": {
        "stopped": 31666,
        "speed_without": 8001,
        "speed_with": 8000,
        "acceleration": 26999,
        "rolling": 3717,
    },
    "nnfm-fairino-franka": {"fairino_s": 11501, "fairino_luoxuan": 11473, "franka_case4_slow": 25349},
    "servo-presliding": {
        "large_1": 12000,
        "large_2": 12000,
        "large_5": 12000,
        "large_8": 12000,
        "breakaway_2": 3000,
        "breakaway_6": 3000,
        "presliding_1": 8000,
        "presliding_2": 8000,
        "presliding_3": 8000,
    },
    "ur10e": {
        "joint_1": 5889,
        "joint_2": 6030,
        **{f"fourier/joint_{k}": 4772 for k in range(1, 7)},
        **{f"fourier_load/joint_{k}": 4764 for k in range(1, 7)},
        **{f"points/joint_{k}": 5347 for k in range(1, 7)},
    },
}


@cache
def _load(data_set: str) -> tuple[NamedRecording, ...]:
    return read_public_named(data_set)


def _read_set(data_set: str) -> dict[str, Recording]:
    if find_public_data(data_set) is None:
        pytest.skip(f"the data of {data_set!r} are not here: FRICOMP_DATA names no folder that holds them")
    return {named.name: named.recording for named in _load(data_set)}


def _read(name: str) -> Recording:
    data_set, _, part = name.partition("/")
    return _read_set(data_set)[part]


def _rms(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_every_mapping_of_the_package_is_tested_here() -> None:
    assert set(SAMPLES) == set(list_mappings())


@pytest.mark.parametrize("data_set", sorted(SAMPLES))
def test_set_gives_its_recordings_with_all_their_samples(data_set: str) -> None:
    found = {name: len(recording) for name, recording in _read_set(data_set).items()}
    assert found == SAMPLES[data_set]


@pytest.mark.parametrize("data_set", sorted(set(SAMPLES) - {"daisy-flexible-arm"}))
def test_no_unit_or_sign_of_a_set_looks_wrong(data_set: str) -> None:
    for name, recording in _read_set(data_set).items():
        errors = [finding for finding in check_recording(recording) if finding.severity == "error"]
        assert not errors, name


def test_emps_force_is_the_gain_times_the_drive_input_on_the_encoders_grid() -> None:
    recording = _read("emps/train")
    counts = recording.position / 5e-8
    assert recording.metadata.motion == "linear"
    assert recording.metadata.torque_unit == "N"
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    assert np.abs(recording.torque).max() == pytest.approx(35.15065 * 4.32566, rel=1e-5)


def test_emps_reproduces_the_published_coulomb_and_viscous_force() -> None:
    recording = _read("emps/train")
    window = np.hanning(21) / np.hanning(21).sum()
    measured = np.gradient(recording.position, recording.time)
    velocity, force, direction = (
        np.convolve(values, window, mode="same") for values in (measured, recording.torque, np.sign(measured))
    )
    acceleration = np.gradient(velocity, recording.time)
    rows = np.arange(400, len(recording) - 400, 10)
    design = np.column_stack([acceleration, velocity, direction, np.ones(len(recording))])[rows]
    mass, viscous, coulomb, offset = np.linalg.lstsq(design, force[rows], rcond=None)[0]
    assert mass == pytest.approx(95.1089, rel=0.005)
    assert viscous == pytest.approx(203.5034, rel=0.005)
    assert coulomb == pytest.approx(20.3935, rel=0.005)
    assert offset == pytest.approx(-3.1648, rel=0.02)


@pytest.mark.parametrize(("name", "speed"), [("ur10e/joint_1", 0.98), ("ur10e/joint_2", 0.65)])
def test_ur10e_joints_reach_the_speed_of_their_description(name: str, speed: float) -> None:
    recording = _read(name)
    assert recording.velocity is not None
    sine = recording.window(10.0, 60.0)
    assert sine.velocity is not None
    assert np.abs(sine.velocity).max() == pytest.approx(speed, abs=0.01)
    assert recording.metadata.torque_unit == "A"
    assert np.abs(recording.metadata.extra["drive_gain"]) > 10 - 1e-9


def test_ur10e_payload_shows_in_the_currents_of_joint_2() -> None:
    free, loaded = _read("ur10e/fourier/joint_2"), _read("ur10e/fourier_load/joint_2")
    assert loaded.metadata.extra["payload"] == 2.805
    rows = min(len(free), len(loaded)) - 1
    shifts = [slice(k, k + rows - 2) for k in range(3)]
    distance = [_rms(free.position[shifts[0]] - loaded.position[shift]) for shift in shifts]
    best = shifts[int(np.argmin(distance))]
    smooth = np.hanning(41) / np.hanning(41).sum()
    difference = np.convolve(loaded.torque[best] - free.torque[shifts[0]], smooth, mode="valid")
    assert _rms(difference) == pytest.approx(1.86, abs=0.15)


def test_laas_feed_forward_cuts_the_squared_speed_error_from_14_76_to_1_39() -> None:
    for name, published in (("laas-cogging/speed_without", 14.76), ("laas-cogging/speed_with", 1.39)):
        recording = _read(name)
        assert recording.velocity is not None
        assert recording.velocity_reference is not None
        error = (recording.velocity - recording.velocity_reference)[recording.time - recording.time[0] > 0.5]
        assert np.mean(error**2) == pytest.approx(published, rel=0.01)


def test_laas_holding_current_and_reference_are_as_described() -> None:
    recording = _read("laas-cogging/stopped")
    assert recording.position_reference is not None
    assert _rms(recording.torque) == pytest.approx(0.145, abs=0.002)
    steps = recording.position_reference / 0.002
    assert np.median(np.abs(steps - np.round(steps))) < 0.01


@pytest.mark.parametrize(
    ("name", "rmse", "ratio", "samples"),
    [("imperial_valley", 2970, 0.508, (3072, 7680)), ("kocaeli", 3341, 0.628, (6144, 14336))],
)
def test_brfd_force_is_in_newton_as_the_authors_prediction(
    name: str, rmse: float, ratio: float, samples: tuple[int, int]
) -> None:
    recording = _read(f"brfd-backlash/{name}")
    folder = find_public_data("brfd-backlash")
    assert folder is not None
    file = {"imperial_valley": "ImperialValleyMCE", "kocaeli": "KocaeliMCE"}[name]
    prediction = np.load(folder / "earthquake-36lb" / f"authors_lugre_prediction_{file}.npy").ravel()
    measured = recording.torque[slice(*samples)]
    assert _rms(measured - prediction) == pytest.approx(rmse, rel=0.01)
    assert _rms(measured - prediction) / np.std(measured) == pytest.approx(ratio, abs=0.005)


def test_brfd_sines_have_the_amplitude_load_and_plateau_of_their_names() -> None:
    plateaus = []
    for load in (20, 35, 80):
        recording = _read(f"brfd-backlash/1hz_{load}lb")
        assert recording.normal_load is not None
        assert recording.velocity is not None
        assert np.ptp(recording.position) / 2 == pytest.approx(0.0254, rel=0.06)
        assert recording.normal_load[0] == pytest.approx(load * 4.4482216)
        plateaus.append(float(np.median(np.abs(recording.torque[np.abs(recording.velocity) > 0.1]))))
    assert plateaus == sorted(plateaus)
    assert plateaus[2] / 4448.22 == pytest.approx(2.39, rel=0.15)


def test_bam_voltage_is_signed_and_within_the_supply_and_positions_are_on_the_grid() -> None:
    names = [name for name in SAMPLES["bam-xl330"] if not name.endswith("free")]
    temperatures = []
    for name in names:
        recording = _read(f"bam-xl330/{name}")
        assert recording.temperature is not None
        assert recording.position_reference is not None
        counts = recording.position / (_TURN / 4096)
        assert np.abs(counts - np.round(counts)).max() < 1e-6
        assert np.abs(recording.torque).max() <= 8.5
        pull = recording.position_reference - recording.position
        assert np.corrcoef(pull, recording.torque)[0, 1] > 0.85
        temperatures.append(float(recording.temperature.mean()))
    assert temperatures[0] < 29
    assert temperatures[-1] > 38


def test_anymal_torque_is_the_target_and_the_reference_leads_the_position() -> None:
    recording = _read("anymal-sea/walk")
    folder = find_public_data("anymal-sea")
    assert folder is not None
    assert np.array_equal(recording.torque, np.fromfile(folder / "data_target0904.bin", "<f8"))
    assert recording.position_reference is not None
    assert recording.velocity is not None
    pull = recording.position_reference - recording.position
    design = np.column_stack([pull, recording.velocity, np.ones(len(recording))])
    errors = []
    for delay in range(8):
        rows, torque = design[: len(recording) - delay], recording.torque[delay:]
        errors.append(_rms(torque - rows @ np.linalg.lstsq(rows, torque, rcond=None)[0]))
    assert int(np.argmin(errors)) in {3, 4}  # 7.5 to 10 ms
    assert errors[0] / min(errors) > 1.3


@pytest.mark.parametrize("name", ["fairino_s", "fairino_luoxuan", "franka_case4_slow"])
def test_nnfm_torque_is_estimated_and_velocity_fits_except_for_franka(name: str) -> None:
    recording = _read(f"nnfm-fairino-franka/{name}")
    assert recording.metadata.torque_kind == "estimated"
    scaled = [finding for finding in check_recording(recording) if finding.code == "velocity_scale"]
    assert bool(scaled) == (name == "franka_case4_slow")


def test_servo_moves_six_encoder_counts_below_breakaway_and_turns_above() -> None:
    below, above = _read("servo-presliding/presliding_1"), _read("servo-presliding/breakaway_2")
    assert np.ptp(below.position) / (_TURN / 10000) == pytest.approx(6.0, abs=0.01)
    assert np.abs(below.torque).max() == pytest.approx(0.012)
    assert above.position[-1] > 20.0
    broke_away = above.torque[np.flatnonzero(above.position > 0.05)[0]]
    assert 0.025 < broke_away < 0.032


def test_flexible_arm_has_acceleration_but_no_motion_to_identify_friction_from() -> None:
    recording = _read("daisy-flexible-arm/sweep")
    assert recording.acceleration is not None
    assert recording.acceleration[0] == pytest.approx(-0.17703630)
    assert {finding.code for finding in check_recording(recording)} == {"no_motion", "time_unit"}


def test_parts_of_a_set_are_found_by_name_and_unknown_ones_refused() -> None:
    _read_set("ur10e")
    (joint_3,) = read_public("ur10e/fourier/joint_3")
    assert joint_3.metadata.joint == "joint_3"
    assert len(read_public("ur10e/fourier_load")) == 6
    with pytest.raises(RecordingError, match="no recording 'fast': valid are joint_1, joint_2, fourier"):
        read_public("ur10e/fast")
    with pytest.raises(RecordingError, match="unknown data set 'ur5': valid are am-d02-arm, anymal-sea"):
        read_public("ur5/joint_1")


def test_absent_data_are_one_clear_error(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("FRICOMP_DATA", str(tmp_path))
    assert find_public_data("emps") is None
    with pytest.raises(RecordingError, match="set FRICOMP_DATA to the folder that holds them"):
        read_public("emps/train")


def test_the_preload_of_a_cycloid_closes_its_gap_and_holds_it_back() -> None:
    clamps = [fit_clamp(_read(f"cycloid-anti-backlash/split_{name}")) for name in ("init", "preload2", "preload3")]
    gaps, friction = [clamp.gap for clamp in clamps], [clamp.friction for clamp in clamps]
    assert gaps == sorted(gaps, reverse=True)
    assert friction == sorted(friction)
    assert all(clamp.residual < 0.4 * clamp.linear_residual for clamp in clamps)


def test_a_dynamometer_shows_gain_and_saturation_of_its_motor() -> None:
    fit = fit_two_torques(_read("moteus-dynamometer/stall"))
    assert fit is not None
    assert fit.gain == pytest.approx(0.91, abs=0.03)
    assert fit.loss == pytest.approx(0.17, abs=0.06)


@pytest.mark.parametrize(("motor", "coulomb"), [(1, 0.535), (5, 0.096)])
def test_free_motors_at_48_hz_give_their_friction(motor: int, coulomb: float) -> None:
    found = identify(_read(f"damiao-joints/motor_{motor}"), law="coulomb_viscous")
    assert found.is_usable
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(coulomb, rel=0.05)


def test_a_motor_that_another_one_drives_is_left_out_while_it_gives_no_torque() -> None:
    for name in ("cogging_1", "cogging_2"):
        usable = find_usable_parts(_read(f"moteus-dynamometer/{name}"))
        assert 60.0 < sum(part.duration for part in usable.parts) < 85.0
        assert any("no torque" in one.reason for one in usable.left_out)
