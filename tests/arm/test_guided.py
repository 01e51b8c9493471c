"""Stretches in which a hand moved the arm are told and left out; what the simulation leaves out is none of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import examine_arm
from fricomp.arm.examination import match_recordings
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .moving_arm import bend_gear, record_arm, write_arm

LEVELS = (1.2, 0.8, 0.3)


def guide(recordings: list[Recording], first: float, last: float) -> list[Recording]:
    """The same in which a hand overcomes the friction for a while, and pulls the arm to and fro besides."""
    guided = []
    for one, level in zip(recordings, LEVELS, strict=True):
        time, position = np.asarray(one.time), np.asarray(one.position)
        pull = level * np.sign(np.gradient(position, time)) + 0.5 * level * np.sin(3.0 * time)
        inside = (time >= first) & (time < last)
        guided.append(one.with_channels(torque=np.asarray(one.torque) - inside * pull))
    return guided


@pytest.mark.parametrize(("first", "last"), [(14.0, 26.0), (30.0, 40.0)])
def test_times_in_which_a_hand_moved_the_arm_are_left_out(tmp_path: Path, first: float, last: float) -> None:
    simulation = write_arm(tmp_path)
    recordings = guide(record_arm(simulation), first, last)
    _, joined = match_recordings(recordings, simulation)
    ((begin, end),) = joined.guided
    assert begin == pytest.approx(first, abs=3.0)
    assert end == pytest.approx(last, abs=3.0)
    assert begin < first
    assert not any(np.any((part.time > first) & (part.time < last)) for part in joined.parts)


def test_friction_is_that_of_the_arm_alone_where_a_hand_moved_it_for_a_while(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    record = examine_arm(guide(record_arm(simulation), 14.0, 26.0), simulation).record
    ((first, last),) = record.guided
    assert f"At {first:.3g} to {last:.3g} s something else than the drives moved or held the arm" in record.summary[1]
    for joint, level in zip(record.joints, LEVELS, strict=True):
        low, high = joint.friction["coulomb"].ci95
        assert low < level < high
        assert joint.friction["coulomb"].value == pytest.approx(level, rel=0.03)


def test_times_count_from_the_start_of_the_recording(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    later = [one.with_channels(time=np.asarray(one.time) + 1e6) for one in guide(record_arm(simulation), 14.0, 26.0)]
    ((first, _),) = match_recordings(later, simulation)[1].guided_from_start
    assert first == pytest.approx(14.0, abs=3.0)


def test_physics_that_is_missing_is_no_hand(tmp_path: Path) -> None:
    """A stop that is met now and then, and links that weigh something else."""

    def stop(joint: int, q: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
        return 40.0 * np.maximum(q - 0.5, 0.0) if joint == 1 else np.zeros_like(q)

    recordings = record_arm(write_arm(tmp_path, (5.0, 2.2, 1.4)), stop)
    assert match_recordings(recordings, write_arm(tmp_path))[1].guided == ()


@pytest.mark.parametrize("stiffness", [60.0, 120.0])
def test_a_gear_that_gives_way_is_no_hand(tmp_path: Path, stiffness: float) -> None:
    """It leaves more than half of their friction of two joints of three, in every stroke that swings."""
    simulation = write_arm(tmp_path)
    recordings = record_arm(simulation, bend=bend_gear(1, stiffness, "motor"))
    assert match_recordings(recordings, simulation)[1].guided == ()
