"""What the checks notice: each fault in turn, on a recording that is healthy otherwise."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Finding, Recording, check_recording, raise_errors, read_checked, write_recording
from fricomp.recording.parts.parts import find_usable_parts

MakeRecording = Callable[..., Recording]

_TURN = 2 * np.pi
_DEGREES = 180 / np.pi


def _codes(recording: Recording) -> dict[str, Finding]:
    return {finding.code: finding for finding in check_recording(recording)}


def _encoded(recording: Recording) -> Recording:
    """The recording as an 18-bit encoder gives it."""
    step = _TURN / 2**18
    return recording.with_channels(position=np.round(recording.position / step) * step)


def _in_degrees(recording: Recording) -> Recording:
    assert recording.velocity is not None
    return recording.with_channels(position=recording.position * _DEGREES, velocity=recording.velocity * _DEGREES)


def test_a_healthy_recording_raises_no_finding(make_recording: MakeRecording) -> None:
    assert check_recording(make_recording()) == ()
    assert check_recording(_encoded(make_recording())) == ()


def test_position_alone_in_degrees_is_an_error_that_names_the_factor(make_recording: MakeRecording) -> None:
    recording = make_recording()
    finding = _codes(recording.with_channels(position=recording.position * _DEGREES))["degrees"]
    assert finding.severity == "error"
    assert "57.3" in finding.message
    assert finding.column == "position"


def test_velocity_alone_in_degrees_is_an_error(make_recording: MakeRecording) -> None:
    recording = make_recording()
    assert recording.velocity is not None
    finding = _codes(recording.with_channels(velocity=recording.velocity * _DEGREES))["degrees"]
    assert (finding.severity, finding.column) == ("error", "velocity")


def test_everything_in_degrees_is_told_by_the_step_of_the_encoder(make_recording: MakeRecording) -> None:
    known = _in_degrees(_encoded(make_recording()))
    assert _codes(known)["degrees"].severity == "error"
    unknown = known.with_metadata(encoder_resolution=None)
    assert "360 / 2^18" in _codes(unknown)["degrees"].message


def test_everything_in_degrees_is_told_by_the_limits_of_the_joint(make_recording: MakeRecording) -> None:
    recording = make_recording().with_metadata(encoder_resolution=None)
    by_position = recording.with_metadata(position_limits=(-1.5, 1.5))
    by_velocity = recording.with_metadata(velocity_limit=4.0)
    assert "ends at 1.5 rad" in _codes(_in_degrees(by_position))["degrees"].message
    assert "ends at 4 rad/s" in _codes(_in_degrees(by_velocity))["degrees"].message
    assert not _codes(by_position)
    assert not _codes(by_velocity)


def test_everything_in_degrees_is_told_by_the_reference(make_recording: MakeRecording) -> None:
    recording = make_recording().with_metadata(encoder_resolution=None)
    with_reference = _in_degrees(recording).with_channels(position_reference=recording.position)
    assert "position_reference" in _codes(with_reference)["degrees"].message


@pytest.mark.parametrize(
    ("weight", "size", "noise"), [(2.0, 1.2, 0.02), (0.4, 1.0, 0.02), (15.0, 0.8, 0.5), (2.0, 2.4, 0.1)]
)
def test_everything_in_degrees_is_told_by_the_sine_of_gravity(weight: float, size: float, noise: float) -> None:
    t = np.arange(0.0, 30.0, 0.004)
    angle = 0.3 + size * np.sin(1.6 * t) + 0.3 * size * np.sin(3.8 * t + 1.0)
    speed = np.gradient(angle, t)
    torque = 0.03 * np.gradient(speed, t) + 0.2 * np.sign(speed) + 0.1 * speed + weight * np.sin(angle)
    torque = torque + noise * np.random.default_rng(8).normal(size=t.size)
    finding = _codes(Recording(t, np.round(angle * _DEGREES, 3), torque))["degrees"]
    assert finding.severity == "error"
    assert 'unit = "deg"' in finding.advice
    assert "continuous: true" in finding.advice
    assert "degrees" not in _codes(Recording(t, angle, torque))


@pytest.mark.parametrize("load", ["gravity", "spring", "bent spring", "cable", "none"])
def test_many_turns_in_radians_are_no_degrees(load: str) -> None:
    t = np.arange(0.0, 30.0, 0.004)
    angle = 30.0 * np.sin(0.6 * t) + 12.0 * np.sin(1.45 * t)
    speed = np.gradient(angle, t)
    torque = 0.01 * np.gradient(speed, t) + 0.2 * np.sign(speed) + 0.01 * speed
    torque += {
        "gravity": 2.0 * np.sin(angle),
        "spring": 0.05 * angle,
        "bent spring": 0.05 * angle + 4e-4 * angle**2,
        "cable": 0.02 * angle + 0.3 * np.tanh(angle / 20.0),
        "none": 0.0 * angle,
    }[load]
    torque += 0.02 * np.random.default_rng(9).normal(size=t.size)
    bends = load not in ("gravity", "none")
    assert _codes(Recording(t, angle, torque)).keys() == {"degrees_likely" if bends else "degrees_suspected"}


@pytest.mark.parametrize("counts", [2**12, 2**14, 10000])
def test_many_turns_in_steps_of_an_encoder_in_radians_are_right(counts: int) -> None:
    t = np.arange(0.0, 30.0, 0.004)
    angle = 30.0 * np.sin(0.6 * t) + 12.0 * np.sin(1.45 * t)
    torque = 0.2 * np.sign(np.gradient(angle)) + 0.05 * angle + 0.02 * np.random.default_rng(9).normal(size=t.size)
    turns = np.round(angle * counts / _TURN) / counts
    assert not _codes(Recording(t, _TURN * turns, torque))
    assert _codes(Recording(t, 360.0 * turns, torque))


@pytest.mark.parametrize("offset", [0.0, 180.0, 57.0])
def test_a_wrap_at_360_is_of_degrees(offset: float) -> None:
    t = np.arange(0.0, 20.0, 0.004)
    angle = 4.0 * np.sin(1.6 * t)
    torque = 0.3 * np.sign(np.cos(1.6 * t)) - 0.1 * np.sin(1.6 * t)
    degrees = (np.round(angle * _DEGREES, 2) + offset) % 360.0 - offset
    finding = _codes(find_usable_parts(Recording(t, degrees, torque)).kept)["degrees"]
    assert "wraps round at 360" in finding.message
    assert 'unit = "deg", unwrap = 6.28319' in finding.advice


@pytest.mark.parametrize("counts", [2000, 10000, 36000])
def test_an_encoder_of_hundreds_of_counts_shows_degrees(counts: int) -> None:
    t = np.arange(0.0, 20.0, 0.004)
    angle = 1.5 * np.sin(1.6 * t) + 0.2 * np.sin(5.1 * t)
    torque = 0.3 * np.sign(np.gradient(angle)) + 0.1 * np.gradient(angle, t)
    turns = np.round(angle * counts / _TURN) / counts
    degrees = _codes(Recording(t, 360.0 * turns, torque))
    if counts == 36000:  # a step of 0.01 may be a rounding of anything
        assert "degrees" not in degrees
    else:
        assert f"360 / {counts}" in degrees["degrees"].message
    assert "degrees" not in _codes(Recording(t, _TURN * turns, torque))


@pytest.mark.parametrize("decimals", [4, 5, 6])
def test_numbers_with_few_decimals_show_the_step_of_an_encoder_in_degrees(decimals: int) -> None:
    time = np.arange(0.0, 20.0, 0.004)
    position = np.round(80.0 * np.sin(0.9 * time) * 2**14 / 360.0) * 360.0 / 2**14
    torque = np.sign(np.cos(0.9 * time)) + 0.1 * np.cos(0.9 * time)
    finding = _codes(Recording(time, np.round(position, decimals), torque))["degrees"]
    assert "360 / 2^14" in finding.message


def test_everything_in_degrees_without_other_evidence_is_suspected(make_recording: MakeRecording) -> None:
    recording = _in_degrees(make_recording().with_metadata(encoder_resolution=None))
    assert _codes(recording)["degrees_likely"].severity == "warning"
    assert "degrees_likely" not in _codes(recording.with_metadata(continuous=True))


@pytest.mark.parametrize(
    ("factor", "code"),
    [(60 / _TURN, "velocity_unit"), (1000.0, "velocity_unit"), (-1.0, "flipped_velocity"), (1.4, "velocity_scale")],
)
def test_velocity_that_is_not_the_derivative_of_position_is_noticed(
    make_recording: MakeRecording, factor: float, code: str
) -> None:
    recording = make_recording()
    assert recording.velocity is not None
    assert code in _codes(recording.with_channels(velocity=recording.velocity * factor))


def test_a_velocity_read_with_another_motors_range_is_asked_about(make_recording: MakeRecording) -> None:
    recording = make_recording()
    assert recording.velocity is not None
    finding = _codes(recording.with_channels(velocity=recording.velocity / 1.66))["velocity_scale"]
    assert "1.66 times" in finding.message
    assert "V_MAX" in finding.advice


def test_velocity_of_another_joint_is_noticed(make_recording: MakeRecording) -> None:
    recording = make_recording()
    other = np.cos(17.0 * recording.time)
    assert "velocity_mismatch" in _codes(recording.with_channels(velocity=other))


def test_velocity_on_the_motor_side_is_named_where_the_gear_is_known(make_recording: MakeRecording) -> None:
    recording = make_recording().with_metadata(gear_ratio=101.0)
    assert recording.velocity is not None
    finding = _codes(recording.with_channels(velocity=recording.velocity * 101.0))["velocity_unit"]
    assert "motor side" in finding.message


def test_flipped_torque_and_reference_are_errors(make_recording: MakeRecording) -> None:
    recording = make_recording()
    assert _codes(recording.with_channels(torque=-recording.torque))["flipped_torque"].severity == "error"
    assert "flipped_reference" in _codes(recording.with_channels(position_reference=-recording.position))


def test_flipped_torque_is_told_by_its_work_where_a_quarter_has_one_direction(make_recording: MakeRecording) -> None:
    recording = make_recording(2000)  # one period: the first quarter only rises
    assert "flipped_torque" not in _codes(recording)
    assert "flipped_torque" in _codes(recording.with_channels(torque=-recording.torque))


def test_gravity_against_the_motion_is_no_flipped_torque(make_recording: MakeRecording) -> None:
    recording = make_recording()
    load = 20.0 * np.cos(recording.position)
    assert "flipped_torque" not in _codes(recording.with_channels(torque=recording.torque + load))


def test_motor_side_torque_without_gear_ratio_is_an_error(make_recording: MakeRecording) -> None:
    recording = make_recording().with_metadata(torque_side="motor")
    assert _codes(recording)["motor_side"].severity == "error"
    assert "motor_side" not in _codes(recording.with_metadata(gear_ratio=50.0))


def test_kelvin_is_noticed(make_recording: MakeRecording) -> None:
    recording = make_recording()
    assert (
        "kelvin"
        in _codes(recording.with_channels(temperature=np.full(len(recording), 300.0)))["temperature_unit"].advice
    )


def test_standstill_is_an_error_and_a_few_encoder_steps_a_warning(make_recording: MakeRecording) -> None:
    recording = make_recording().with_channels(velocity=None)
    still = recording.with_channels(position=np.full(len(recording), 0.3))
    assert _codes(still)["no_motion"].severity == "error"
    few = recording.with_channels(position=_TURN / 2**18 * np.round(3 * np.sin(recording.time)))
    assert _codes(few)["no_sliding"].severity == "warning"


def test_long_rest_is_noted_with_its_share(make_recording: MakeRecording) -> None:
    recording = make_recording(10000).with_channels(velocity=None)
    position = np.where(recording.time < 3.0, recording.position, recording.position[3000])
    assert re.search(r"for (69|70|71) %", _codes(recording.with_channels(position=position))["rest"].message)


@pytest.mark.parametrize("column", ["torque", "velocity", "position"])
def test_stuck_channel_is_named_with_its_first_row(make_recording: MakeRecording, column: str) -> None:
    recording = make_recording()
    values = recording.channels[column].copy()
    values[1300:1700] = values[1300]
    finding = _codes(recording.with_channels(**{column: values}))["stuck"]
    assert (finding.row, finding.column) == (1301, column)


@pytest.mark.parametrize(("lag", "dead"), [(0.01, True), (0.5, False)])
def test_a_soft_loop_may_leave_the_joint_in_stiction(make_recording: MakeRecording, lag: float, dead: bool) -> None:
    recording = make_recording()
    position = recording.position.copy()
    position[1300:1700] = position[1300]
    behind = 0.8 * np.sin(np.pi * (recording.time + lag))  # what the loop follows late
    channels = {name: recording.channels[name] for name in ("time", "torque")}
    held = Recording.from_channels(channels | {"position": position, "position_reference": behind}, recording.metadata)
    assert ("stuck" in _codes(held)) == dead


def test_commanded_torque_may_stay_constant(make_recording: MakeRecording) -> None:
    recording = make_recording()
    steps = np.where(recording.torque > 0, 0.5, -0.5)
    assert "stuck" in _codes(recording.with_channels(torque=steps)) or "saturated" in _codes(
        recording.with_channels(torque=steps)
    )
    assert not _codes(recording.with_channels(torque=steps).with_metadata(torque_kind="commanded"))


@pytest.mark.parametrize(("period", "offset"), [(_TURN, np.pi), (0.5, 0.0)])
def test_wraps_are_errors_with_row_and_size(make_recording: MakeRecording, period: float, offset: float) -> None:
    recording = make_recording().with_metadata(continuous=True)
    turning = 4.0 * recording.time + 0.01 * np.sin(recording.time)
    finding = _codes(recording.with_channels(position=(turning + offset) % period, velocity=None))["wrap"]
    row = int(np.flatnonzero(np.diff((turning + offset) % period) < 0)[0]) + 2
    assert (finding.severity, finding.row) == ("error", row)


def test_lost_counts_are_a_jump(make_recording: MakeRecording) -> None:
    recording = make_recording()
    position = recording.position + np.where(recording.time > 2.0, 0.2, 0.0)
    assert _codes(recording.with_channels(position=position))["jump"].row == 2002


def test_a_short_fast_motion_in_a_slow_recording_is_no_jump(make_recording: MakeRecording) -> None:
    recording = make_recording().with_channels(velocity=None)
    burst = 2.0 * np.clip(recording.time - 3.0, 0.0, 0.05)
    assert not _codes(recording.with_channels(position=1e-4 * recording.time + burst)).keys() & {"jump", "wrap"}


def test_single_wild_samples_are_spikes(make_recording: MakeRecording) -> None:
    recording = make_recording()
    torque = recording.torque.copy()
    torque[700] = 9.0
    finding = _codes(recording.with_channels(torque=torque))["spike"]
    assert (finding.row, finding.column) == (701, "torque")


def test_positions_far_outside_all_others_are_told_as_such_and_as_no_wrap() -> None:
    t = np.arange(0.0, 30.0, 0.002)
    position = 0.9 * np.sin(2.0 * t)
    for row, far in ((3000, 6.1), (7011, 6.3), (11020, 5.9)):
        position[row] += far
    found = _codes(Recording(t, position, np.sign(np.cos(2.0 * t))))
    assert not found.keys() & {"wrap", "jump"}
    assert (found["spike"].row, found["spike"].column) == (3001, "position")
    assert "identify and diagnose leave these rows out" in found["spike"].advice
    wrapping = np.mod(3.0 * t, 2.0 * np.pi)
    assert "wrap" in _codes(Recording(t, wrapping, np.ones(t.size)))


def test_a_lone_torque_that_stands_for_a_current_as_well_is_told_once(make_recording: MakeRecording) -> None:
    recording = make_recording()
    torque = recording.torque.copy()
    torque[700] = 9.0
    told = [
        one for one in check_recording(recording.with_channels(torque=torque, current=torque)) if one.code == "spike"
    ]
    assert [one.column for one in told] == ["torque"]
    assert "the joint does not answer" in told[0].advice


def test_gap_jitter_and_change_of_rate_are_told_apart(make_recording: MakeRecording) -> None:
    recording = make_recording()
    gap = recording.rows((recording.time < 1.0) | (recording.time > 1.2))
    assert _codes(gap)["gap"].row == 1001
    jitter = np.random.default_rng(3).uniform(-4e-4, 4e-4, len(recording))
    assert set(_codes(recording.with_channels(time=recording.time + jitter))) == {"jitter"}
    two = recording.rows((recording.time < 2.0) | (np.arange(len(recording)) % 2 == 0))
    assert _codes(two)["two_rates"].severity == "error"


@pytest.mark.parametrize(("rate", "is_low"), [(49.99, False), (48.0, True)])
def test_a_clock_that_is_slightly_off_makes_no_low_rate(rate: float, is_low: bool) -> None:
    time = np.arange(0.0, 20.0, 1.0 / rate)
    recording = Recording(time, np.sin(0.9 * time), np.sign(np.cos(0.9 * time)))
    assert ("low_rate" in _codes(recording)) is is_low


def test_low_rate_and_milliseconds_are_noticed(make_recording: MakeRecording) -> None:
    assert _codes(make_recording(400, 0.04))["low_rate"].severity == "warning"
    recording = make_recording()
    assert _codes(recording.with_channels(time=1000 * recording.time))["time_unit"].severity == "error"


def test_findings_come_gravest_first_and_errors_can_be_raised(make_recording: MakeRecording) -> None:
    recording = make_recording(10000)
    position = np.where(recording.time < 3.0, recording.position, recording.position[3000])
    bad = recording.with_channels(position=position, velocity=None, torque=-recording.torque)
    bad = bad.with_metadata(torque_side="motor")
    findings = check_recording(bad)
    assert findings[0].severity == "error"
    assert findings[-1].severity == "note"
    with pytest.raises(RecordingError, match=r"my\.csv: .*column torque: .*gear_ratio"):
        raise_errors([finding for finding in findings if finding.code == "motor_side"], "my.csv")
    raise_errors([finding for finding in findings if finding.severity == "note"], "my.csv")


def test_checked_reading_returns_findings_of_file_and_samples(make_recording: MakeRecording, tmp_path: Path) -> None:
    path = tmp_path / "recording.csv"
    recording = make_recording()
    write_recording(recording.with_channels(torque=-recording.torque), path)
    path.write_bytes(path.read_bytes()[:-3])
    checked = read_checked(path)
    assert len(checked.recording) == 3999
    assert {finding.code for finding in checked.findings} == {"torn_line", "flipped_torque"}
