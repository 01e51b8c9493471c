"""The recording: validated once, read-only, sliced and joined without losing its meaning."""

import pickle
from collections.abc import Callable

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording, RecordingMetadata, concatenate
from fricomp.recording.metadata import channel_units
from fricomp.recording.recording import CHANNELS

MakeRecording = Callable[..., Recording]


def test_arrays_are_float64_copies_that_cannot_be_written(make_recording: MakeRecording) -> None:
    position = np.arange(100, dtype=np.int64)
    recording = make_recording(100).with_channels(position=position)
    position[0] = 99
    assert recording.position.dtype == np.float64
    assert recording.position[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        recording.position[0] = 1.0


@pytest.mark.parametrize(("value", "said"), [(np.nan, "nan is not a finite"), (-1e300, "-1e\\+300 is larger than any")])
def test_what_is_no_reading_is_refused_with_row_column_and_advice(
    make_recording: MakeRecording, value: float, said: str
) -> None:
    torque = np.zeros(100)
    torque[41] = value
    with pytest.raises(RecordingError, match=rf"row 42, column torque: {said} .* --skip-bad-rows"):
        make_recording(100).with_channels(torque=torque)


@pytest.mark.parametrize(
    ("value", "message"), [(0.039, "row 42, column time.*falls"), (0.040, "row 42.*stamped twice")]
)
def test_time_that_does_not_rise_is_refused(make_recording: MakeRecording, value: float, message: str) -> None:
    time = make_recording(100).time.copy()
    time[41] = value
    with pytest.raises(RecordingError, match=message):
        make_recording(100).with_channels(time=time)


def test_time_that_goes_on_by_less_than_any_clock_counts_is_refused(make_recording: MakeRecording) -> None:
    whole, rows = make_recording(100), np.arange(100.0)
    assert whole.with_channels(time=1e-8 * rows).sample_period == pytest.approx(1e-8)
    for period in (1e-10, 1e-300, 1e-320):
        with pytest.raises(RecordingError, match=r"time goes on by .* from row to row.*unit of time"):
            whole.with_channels(time=period * rows)


def test_channels_of_other_length_are_refused(make_recording: MakeRecording) -> None:
    with pytest.raises(RecordingError, match=r"column velocity: velocity has shape \(99,\)"):
        make_recording(100).with_channels(velocity=np.zeros(99))


def test_unknown_channel_is_refused_with_the_valid_names(make_recording: MakeRecording) -> None:
    with pytest.raises(RecordingError, match="unknown channel 'speed': valid are time, position"):
        make_recording(10).with_channels(speed=np.zeros(10))


def test_window_keeps_start_and_leaves_stop_out(make_recording: MakeRecording) -> None:
    part = make_recording(100).window(0.010, 0.020)
    assert len(part) == 10
    assert part.time[0] == pytest.approx(0.010)
    assert part.velocity is not None
    with pytest.raises(RecordingError, match=r"spans 0\.\.0\.099 s"):
        make_recording(100).window(5.0, 6.0)


@pytest.mark.parametrize(
    ("said", "left"),
    [
        ("2026-03-14T10:00:00.000+00:00", "2026-03-14T10:00:00.050+00:00"),
        ("2026-03-14T10:00:00", "2026-03-14T10:00:00.050"),
        ("2026-03-14", "2026-03-14"),
        ("spring: wet", "spring: wet"),
        ("", ""),
    ],
)
def test_rows_that_are_left_were_recorded_later(said: str, left: str, make_recording: MakeRecording) -> None:
    recording = make_recording(100).with_metadata(recorded=said)
    assert recording.window(0.050, 0.090).metadata.recorded == left
    assert recording.window(0.0, 0.090).metadata.recorded == said


def test_concatenation_with_a_gap_shifts_time_and_keeps_shared_channels(make_recording: MakeRecording) -> None:
    first = make_recording(50)
    second = make_recording(30).with_channels(velocity=None)
    joined = concatenate([first, second], gap=0.5)
    assert len(joined) == 80
    assert joined.velocity is None
    assert joined.time[50] - joined.time[49] == pytest.approx(0.5)


def test_concatenation_refuses_overlap_and_other_units(make_recording: MakeRecording) -> None:
    with pytest.raises(RecordingError, match="row 51, column time"):
        concatenate([make_recording(50), make_recording(50)])
    linear = make_recording(50).with_metadata(motion="linear", torque_unit="N")
    with pytest.raises(RecordingError, match=r"rotary \[N·m\] with linear \[N\]"):
        concatenate([make_recording(50), linear], gap=1.0)


def test_content_hash_follows_samples_and_metadata(make_recording: MakeRecording) -> None:
    recording = make_recording(100)
    torque = recording.torque.copy()
    torque[3] = np.nextafter(torque[3], 1.0)
    assert recording.content_hash == make_recording(100).content_hash
    assert recording.with_channels(torque=torque).content_hash != recording.content_hash
    assert recording.with_metadata(joint="wrist").content_hash != recording.content_hash


def test_metadata_defaults_follow_the_motion_and_spellings_are_unified() -> None:
    assert RecordingMetadata().torque_unit == "N·m"
    assert RecordingMetadata(motion="linear").torque_unit == "N"
    assert RecordingMetadata(torque_unit="Nm") == RecordingMetadata()


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"motion": "angular"}, "valid are rotary, linear"),
        ({"torque_side": "load"}, "valid are joint, motor"),
        ({"gear_ratio": -1.0}, "gear_ratio is -1.0: give a positive number"),
        ({"position_limits": (1.0, -1.0)}, "the lower limit comes first"),
    ],
)
def test_bad_metadata_is_refused_with_the_valid_values(fields: dict[str, object], message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        RecordingMetadata(**fields)  # type: ignore[arg-type]


def test_pickled_recording_stays_read_only_and_the_same(make_recording: MakeRecording) -> None:
    again = pickle.loads(pickle.dumps(make_recording(100)))
    assert again.content_hash == make_recording(100).content_hash
    with pytest.raises(ValueError, match="read-only"):
        again.torque[0] = 1.0


def test_motor_torque_comes_to_the_joint_through_the_gear(make_recording: MakeRecording) -> None:
    motor = make_recording(100).with_metadata(torque_side="motor", gear_ratio=50.0)
    assert motor.on_joint_side().torque == pytest.approx(50.0 * motor.torque)
    assert motor.on_joint_side().metadata.torque_side == "joint"
    current = motor.with_metadata(torque_unit="A")
    assert current.on_joint_side().torque.tolist() == motor.torque.tolist()
    screw = motor.with_metadata(motion="linear").on_joint_side()
    assert screw.metadata.torque_unit == "N"
    with pytest.raises(RecordingError, match="gear_ratio is unknown"):
        motor.with_metadata(gear_ratio=None).on_joint_side()


def test_every_channel_has_a_unit() -> None:
    assert set(channel_units(RecordingMetadata())) == set(CHANNELS)
