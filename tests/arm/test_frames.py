"""Torques that were recorded with the opposite sign are turned round, and nothing else is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.examination import examine_arm, match_recordings
from fricomp.arm.search.frames import find_better_frames, find_torque_scales
from fricomp.arm.words.corrections import say_turned
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .moving_arm import JOINTS, record_arm, write_arm


def _turn(recordings: Sequence[Recording], joints: Sequence[str]) -> list[Recording]:
    return [one.with_channels(torque=-one.torque) if one.metadata.joint in joints else one for one in recordings]


@pytest.mark.parametrize("joints", [(), *((name,) for name in JOINTS), JOINTS])
def test_torques_of_the_opposite_sign_are_turned_round(joints: tuple[str, ...], tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    guessed = write_arm(tmp_path, (6.0, 1.5, 2.0), (0.1, 0.2, 0.1))
    _, found = match_recordings(_turn(recordings, joints), guessed)
    assert found.turned == joints
    for one, before in zip(found.recordings, recordings, strict=True):
        assert np.array_equal(one.torque, before.torque)


def test_a_torque_that_nothing_explains_is_left_as_it_is(tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    noise = np.random.default_rng(3).normal(size=recordings[1].time.size)
    recordings[1] = recordings[1].with_channels(torque=np.cumsum(noise))
    assert match_recordings(recordings, write_arm(tmp_path))[1].turned == ()


def test_what_was_turned_is_told() -> None:
    assert say_turned(()) == ()
    assert say_turned(("elbow",))[0].startswith("The torque of elbow was recorded with the opposite sign")


@pytest.mark.parametrize(("direction", "offset"), [(1, 0.5 * np.pi), (1, np.pi), (-1, -0.5 * np.pi), (-1, 0.0)])
def test_another_zero_or_direction_is_told(direction: int, offset: float, tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    seen = recordings[1]
    recordings[1] = seen.with_channels(position=direction * (seen.position - offset), torque=direction * seen.torque)
    arm, recording = match_recordings(recordings, write_arm(tmp_path, (4.4, 2.2, 1.1)))
    (frame,) = find_better_frames(arm, recording)
    assert (frame.joint, frame.direction) == ("elbow", direction)
    assert abs(np.exp(1j * frame.offset) - np.exp(1j * offset)) < 1e-9


@pytest.mark.parametrize("masses", [(4.0, 2.5, 1.2), (6.0, 1.5, 2.0), (4.0, 2.5, 3.0)])
def test_of_an_arm_with_wrong_links_no_other_frame_is_told(masses: tuple[float, float, float], tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    assert find_better_frames(*match_recordings(recordings, write_arm(tmp_path, masses))) == ()


@pytest.mark.parametrize("factor", [1.0 / 81.0, 100.0])
def test_a_torque_in_another_unit_is_told(factor: float, tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    recordings[1] = recordings[1].with_channels(torque=factor * recordings[1].torque)
    scales = find_torque_scales(*match_recordings(recordings, write_arm(tmp_path, (4.4, 2.2, 1.1))))
    assert scales == {"elbow": pytest.approx(factor, rel=0.3)}


def test_links_that_are_guessed_are_no_other_unit(tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    assert find_torque_scales(*match_recordings(recordings, write_arm(tmp_path, (1.5, 1.5, 1.5)))) == {}


def test_what_the_arm_carries_is_no_other_unit_of_the_joint_that_carries_little_else(tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=20.0, rate=100.0)
    arm, joined = match_recordings(recordings, light := write_arm(tmp_path, (4.0, 2.5, 0.15)))
    assert set(find_torque_scales(arm, joined)) == {"wrist"}
    assert examine_arm(recordings, light).record.torque_scales == {}


@pytest.mark.parametrize(("joint", "factor"), [(1, 8.0), (2, 8.0), (2, 0.1)])
def test_another_unit_is_told_whatever_the_links_were_fitted_to(joint: int, factor: float, tmp_path: Path) -> None:
    recordings = record_arm(simulation := write_arm(tmp_path), duration=20.0, rate=100.0)
    recordings[joint] = recordings[joint].with_channels(torque=factor * recordings[joint].torque)
    assert set(examine_arm(recordings, simulation).record.torque_scales) == {recordings[joint].metadata.joint}


@pytest.mark.parametrize("seed", [2, 4])
def test_links_that_ask_for_little_tell_no_unit(seed: int, tmp_path: Path) -> None:
    """Beside the friction of a wrist and what bends it, any factor on a light hand is as good as none."""

    def bend(joint: int, q: FloatArray, v: FloatArray, _: FloatArray) -> FloatArray:
        return np.sign(v) - 0.25 * np.sin(q) + 0.3 * np.sin(5.0 * q) if joint == 2 else np.zeros_like(q)

    light = write_arm(tmp_path, (4.0, 2.5, 0.02))
    recordings = record_arm(light, bend, seed=seed, duration=60.0, rate=100.0)
    assert find_torque_scales(*match_recordings(recordings, light)) == {}


@pytest.mark.parametrize("velocity", [None, 1.0, np.pi / 180.0])
def test_positions_in_degrees_are_taken_so(velocity: float | None, tmp_path: Path) -> None:
    """And velocities with them where they are degrees as well."""
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0)
    read = [one.with_channels(position=np.rad2deg(one.position)) for one in recordings]
    if velocity is not None:
        read = [one.with_channels(velocity=velocity * np.gradient(one.position, one.time)) for one in read]
    _, found = match_recordings(read, write_arm(tmp_path, (4.4, 2.2, 1.5)))
    assert found.degrees
    for one, before in zip(found.recordings, recordings, strict=True):
        assert one.position == pytest.approx(before.position)
        assert one.velocity is None or one.velocity == pytest.approx(np.gradient(before.position, one.time), abs=1e-6)


def test_joints_that_turn_round_and_round_are_in_radians(tmp_path: Path) -> None:
    recordings = record_arm(write_arm(tmp_path), duration=10.0, rate=100.0, size=4.0)
    assert max(np.ptp(one.position) for one in recordings) > 2.0 * np.pi
    assert not match_recordings(recordings, write_arm(tmp_path, (4.4, 2.2, 1.5)))[1].degrees
