"""What is left out of a recording, and that nothing else is."""

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording, concatenate
from fricomp.recording.parts.parts import find_usable_parts

from ..joint_log import joint_log

RNG = np.random.default_rng(7)


def _with(recording: Recording, rows: slice | np.ndarray, **values: float) -> Recording:
    changed = {name: np.array(recording.channels[name]) for name in values}
    for name, value in values.items():
        changed[name][rows] = value
    return recording.with_channels(**changed)


@pytest.mark.parametrize(("rate", "seed"), [(200.0, 1), (1000.0, 2)])
def test_a_good_recording_is_its_own_only_part(rate: float, seed: int) -> None:
    good = joint_log(12.0, rate, seed)
    usable = find_usable_parts(good)
    assert usable.kept is good
    assert usable.parts == (good,)
    assert usable.sentences == ()


@pytest.mark.parametrize("seed", [3, 4])
def test_gaps_cut_a_recording_and_the_line_says_how_much_is_left(seed: int) -> None:
    log = joint_log(30.0, 400.0, seed)
    cut = log.rows(((log.time < 8.0) | (log.time > 11.5)) & ((log.time < 20.0) | (log.time > 20.3)))
    usable = find_usable_parts(cut)
    assert len(usable.parts) == 3
    assert sum(len(part) for part in usable.parts) == len(cut)
    assert "in 3 parts" in usable.sentences[0]


def test_a_gap_that_a_straight_line_bridges_cuts_nothing() -> None:
    log = joint_log(20.0, 1000.0)
    usable = find_usable_parts(log.rows(np.r_[0:9000, 9012 : len(log)]))
    assert len(usable.parts) == 1


@pytest.mark.parametrize("seed", [1, 2])
def test_rows_lost_in_bursts_all_along_cut_nothing(seed: int) -> None:
    log, rng = joint_log(20.0, 1000.0), np.random.default_rng(seed)
    keep = np.ones(len(log), dtype=bool)
    for row in rng.integers(20, len(log) - 20, 70):
        keep[row : row + rng.integers(2, 14)] = False
    assert len(find_usable_parts(log.rows(keep)).parts) == 1


@pytest.mark.parametrize("rest", [20.0, 46.0])
def test_a_long_rest_is_left_out_and_two_seconds_beside_the_motion_stay(rest: float) -> None:
    log, n = joint_log(32.0, 250.0, 5), round(rest * 250)
    first, second = log.rows(slice(0, 4000)), log.rows(slice(4000, 8000))
    still = Recording(
        np.arange(n) / 250.0,
        np.full(n, first.position[-1]),
        0.1 + RNG.normal(0.0, 0.004, n),
        velocity=np.zeros(n),
        metadata=log.metadata,
    )
    usable = find_usable_parts(concatenate([first, still, second], gap=1 / 250.0))
    assert any(one.reason == "rows of long rests" for one in usable.left_out)
    assert usable.kept.duration > 30.0
    assert rest - 6.0 < sum(one.duration for one in usable.left_out) < rest


@pytest.mark.parametrize("at_start", [True, False])
def test_of_a_rest_at_an_end_only_what_is_beside_the_motion_stays(at_start: bool) -> None:
    """Else the other end of it would be a part that never moves."""
    log, n = joint_log(20.0, 250.0, 7), 5000
    held = np.full(n, log.position[0 if at_start else -1])
    still = Recording(np.arange(n) / 250.0, held, np.zeros(n), velocity=np.zeros(n), metadata=log.metadata)
    (only,) = find_usable_parts(concatenate([still, log] if at_start else [log, still], gap=1 / 250.0)).parts
    assert len(log) + 1.9 * 250 < len(only) < len(log) + 2.1 * 250
    assert np.ptp(only.position) == np.ptp(log.position)


@pytest.mark.parametrize("others", [1, 2])
@pytest.mark.parametrize(("rate", "seed"), [(50.0, 3), (250.0, 8)])
def test_others_that_publish_as_often_as_the_joint_are_left_out(others: int, rate: float, seed: int) -> None:
    log = joint_log(20.0, rate, seed)
    times = 1 + others
    time = np.ravel(np.asarray(log.time)[:, None] + 0.3 * np.arange(times) / rate)
    channels = {name: np.repeat(values, times) for name, values in log.channels.items() if name != "time"}
    of_joint = np.arange(time.size) % times == 0
    zeros = {name: np.where(of_joint, values, 0.0) for name, values in channels.items()}
    usable = find_usable_parts(Recording.from_channels({"time": time, **zeros}, log.metadata))
    assert len(usable.kept) == pytest.approx(len(log), abs=0.02 * len(log))
    assert np.mean(np.isin(usable.kept.position, log.position)) == 1.0


@pytest.mark.parametrize("share", [0.01, 0.05, 0.2])
def test_rows_of_another_publisher_are_left_out_wherever_the_joint_is(share: float) -> None:
    log = joint_log(20.0, 500.0, 6)
    others = RNG.random(len(log)) < share
    usable = find_usable_parts(_with(log, others, position=0.0, torque=0.0, velocity=0.0))
    count = np.count_nonzero(others)
    assert count <= usable.left_out[0].rows < 1.2 * count
    assert not np.isin(usable.kept.time, log.time[others]).any()


def test_a_torn_stretch_and_single_outliers_of_position_are_left_out() -> None:
    log = joint_log(20.0, 500.0, 8)
    torn = _with(log, slice(3000, 3200), position=0.0)
    torn = _with(torn, np.array([500, 5000, 7777]), position=40.0)
    usable = find_usable_parts(torn)
    assert sum(one.rows for one in usable.left_out) == pytest.approx(203, abs=4)
    assert np.max(np.abs(usable.kept.position)) < 2.0


def test_a_position_that_jumps_for_good_is_cut_there() -> None:
    log = joint_log(20.0, 500.0, 9)
    elsewhere = 4500 + int(np.argmax(np.abs(log.position[4500:6000] - log.position[4499])))
    lost = log.rows(np.r_[0:4500, elsewhere : len(log)])
    usable = find_usable_parts(lost.with_channels(time=np.arange(len(lost)) / 500.0))
    assert [len(part) for part in usable.parts] == [4500, len(log) - elsewhere]


@pytest.mark.parametrize("period", [2.0 * np.pi, 25.0, 4.0 * np.pi])
def test_a_counter_that_wraps_is_unwrapped_by_its_own_range(period: float) -> None:
    log = joint_log(20.0, 500.0, 10)
    far = 0.55 * period * np.sin(2.0 * np.pi * 0.11 * log.time) + 0.02 * log.position
    count = 2.0 * np.pi / 2**14
    wrapped = np.round((np.mod(far + 0.5 * period, period) - 0.5 * period) / count) * count
    usable = find_usable_parts(log.with_channels(position=wrapped, velocity=None))
    assert np.ptp(usable.kept.position - far) < 3.0 * count
    assert f"{period:.6g}" in usable.sentences[0]


@pytest.mark.parametrize("moved", [0.6, 0.8])
def test_a_counter_that_wraps_is_unwrapped_beside_a_gap_in_which_the_joint_moves_on(moved: float) -> None:
    log, period = joint_log(20.0, 500.0, 10), 2.0 * np.pi
    far = 0.55 * period * np.sin(2.0 * np.pi * 0.11 * log.time) + 0.02 * log.position
    wrapped = log.with_channels(position=np.mod(far + 0.5 * period, period) - 0.5 * period, velocity=None)
    begin = int(np.argmax(far < -0.43 * period))
    behind = begin + int(np.argmax(far[begin:] > (moved - 0.43) * period))  # nearly as far as a wrap, and none
    kept = np.r_[0:begin, behind : len(log)]
    found = find_usable_parts(wrapped.rows(kept))
    assert any("it wraps round" in line and "6.28319" in line for line in found.sentences)
    for part in found.parts:
        there = np.interp(part.time, log.time, far)
        assert np.ptp(part.position - there) < 1e-3


@pytest.mark.parametrize("rows", [3, 15])
def test_held_rows_are_thinned_to_the_rate_of_the_readings(rows: int) -> None:
    log = joint_log(30.0, 1000.0, 11)
    index = np.arange(len(log)) // rows * rows
    held = {name: values[index] for name, values in log.channels.items() if name != "time"}
    usable = find_usable_parts(log.with_channels(**held))
    assert usable.left_out == ()  # and none of them is a reading that failed
    assert usable.kept.sample_period == pytest.approx(rows * 1e-3, rel=0.01)
    assert f"{1000.0 / rows:.4g} Hz" in usable.sentences[-1]


@pytest.mark.parametrize("after", [1, 7])
def test_a_torque_that_comes_in_other_rows_than_the_position_is_not_late_once_thinned(after: int) -> None:
    log, rows = joint_log(30.0, 1000.0, 11), 15
    first = np.arange(len(log)) // rows * rows
    later = np.maximum((np.arange(len(log)) - after) // rows * rows + after, 0)
    held = {"position": log.position[first], "velocity": None, "torque": log.torque[later]}
    kept = find_usable_parts(log.with_channels(**held)).kept
    truth = np.interp(kept.time, log.time, log.torque)
    stale = log.torque[later][np.searchsorted(log.time, kept.time - 1e-9)]
    assert np.std(kept.torque - truth) < 0.35 * np.std(stale - truth)


def test_a_slow_joint_with_a_coarse_encoder_keeps_its_rows() -> None:
    log = joint_log(30.0, 1000.0, 12)
    coarse = np.round(0.02 * log.position / 1e-3) * 1e-3
    assert len(find_usable_parts(log.with_channels(position=coarse, velocity=None)).kept) == len(log)


def test_a_saturated_stretch_of_torque_is_left_out() -> None:
    log = joint_log(20.0, 500.0, 13)
    limit = float(np.quantile(np.abs(log.torque), 0.85))
    clipped = np.clip(log.torque, -limit, limit)
    usable = find_usable_parts(log.with_channels(torque=clipped))
    left = {one.reason: one.rows for one in usable.left_out}
    assert left.get("rows of stuck or saturated stretches", 0) > 0


def test_a_torque_in_coarse_steps_is_not_stuck() -> None:
    log = joint_log(20.0, 500.0, 14)
    assert find_usable_parts(log.with_channels(torque=np.round(log.torque / 0.2) * 0.2)).left_out == ()


def test_a_velocity_without_a_code_for_zero_is_no_motion() -> None:
    log = joint_log(20.0, 500.0, 15)
    position = np.array(log.position)
    position[2000:3000] = position[2000]
    step = 90.0 / 4095
    codes = (
        np.floor(np.where(np.arange(len(log)) // 1000 == 2, 0.0, np.asarray(log.velocity, dtype=np.float64)) / step)
        + 0.5
    ) * step
    resting = log.with_channels(position=position, velocity=codes)
    assert not any("stuck" in one.reason for one in find_usable_parts(resting).left_out)


@pytest.mark.parametrize(("bits", "count"), [(16, 2.69e-3), (12, 4e-3)])
def test_a_torque_that_was_read_as_unsigned_has_its_signs(bits: int, count: float) -> None:
    log = joint_log(20.0, 320.0, 9)
    counts = np.round(log.torque / count)
    usable = find_usable_parts(log.with_channels(torque=np.mod(counts, 2**bits) * count))
    assert usable.kept.torque == pytest.approx(counts * count, abs=1e-6)
    assert any(f"signed number of {bits} bits" in one and "signed_range" in one for one in usable.sentences)


@pytest.mark.parametrize(("rate", "share", "seed"), [(250.0, 0.03, 1), (1000.0, 0.005, 2), (100.0, 0.08, 3)])
def test_torques_of_failed_readings_are_left_out(rate: float, share: float, seed: int) -> None:
    log = joint_log(30.0, rate, seed)
    failed = np.random.default_rng(seed).random(len(log)) < share
    usable = find_usable_parts(_with(log, failed, torque=0.0))
    (left,) = usable.left_out
    assert left.reason == "rows whose reading of torque failed and was logged as 0"
    assert left.rows == pytest.approx(np.count_nonzero(failed), rel=0.1)
    assert not np.any(np.asarray(usable.kept.torque) == 0.0)
    assert not any(one.code == "jitter" for one in check_recording(usable.kept))


def test_a_torque_of_zero_while_the_drive_is_off_was_there() -> None:
    log = joint_log(30.0, 250.0, 5)
    off = (np.asarray(log.time) % 5.0 < 0.2) & (np.abs(np.asarray(log.torque)) < 0.5)
    usable = find_usable_parts(_with(log, off, torque=0.0))
    assert not any("outlier of torque" in one.reason for one in usable.left_out)


@pytest.mark.parametrize(("rate", "share", "seed"), [(250.0, 0.1, 6), (1000.0, 0.02, 7)])
def test_rows_of_readings_that_failed_and_repeat_the_one_before_are_left_out(
    rate: float, share: float, seed: int
) -> None:
    log = joint_log(30.0, rate, seed)
    before = np.arange(len(log))
    failed = np.random.default_rng(seed).random(len(log)) < share
    failed[0] = False
    before[failed] -= 1
    usable = find_usable_parts(log.with_channels(**{k: v[before] for k, v in log.channels.items() if k != "time"}))
    (left,) = usable.left_out
    assert left.reason == "rows that repeat the one before while the joint moves"
    assert 0.5 * np.count_nonzero(failed) < left.rows <= np.count_nonzero(failed)
    assert len(usable.parts) == 1


@pytest.mark.parametrize(("rate", "held"), [(50.0, 3), (200.0, 4), (500.0, 2)])
def test_outliers_at_one_value_are_no_counter_that_wraps(rate: float, held: int) -> None:
    log = joint_log(24.0, rate, 40)
    rows = np.random.default_rng(41).choice(len(log) - 2 * held, 6, replace=False) + held
    usable = find_usable_parts(_with(log, (rows[:, None] + np.arange(held)).ravel(), position=55.0))
    assert not any("wraps" in one for one in usable.sentences)
    assert np.ptp(usable.kept.position) == pytest.approx(np.ptp(log.position), rel=0.05)


@pytest.mark.parametrize(("rate", "start"), [(125.0, 2.0), (200.0, 9.3), (100.0, 14.1)])
def test_a_torn_stretch_is_left_out_of_a_slow_log_too(rate: float, start: float) -> None:
    time = np.arange(int(24.0 * rate)) / rate
    position = 0.5 * np.sin(2.0 * np.pi * (0.1 * time + 0.025 * time**2)) + 0.3
    torn = (time >= start) & (time < start + 1.2)
    log = Recording(time, np.where(torn, 0.0, position), np.sign(np.gradient(position)) + 0.2 * np.gradient(position))
    usable = find_usable_parts(log)
    assert sum(len(part) for part in usable.parts) <= len(log) - np.count_nonzero(torn)
    assert sum(len(part) for part in usable.parts) > 0.9 * len(log) - np.count_nonzero(torn)
