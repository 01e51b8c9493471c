"""A torque whose sign turns within a log is named with its time; gravity that turns, or a change of size, is none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording

from ..joint_log import joint_log


def _turn(log: Recording, start: float, stop: float) -> Recording:
    """The log with its torque turned from one part of its time to another."""
    part = np.linspace(0.0, 1.0, len(log), endpoint=False)
    return log.with_channels(torque=np.where((part >= start) & (part < stop), -log.torque, log.torque))


def _changes(log: Recording) -> list[str]:
    return [str(one) for one in check_recording(log) if one.code == "sign_change"]


@pytest.mark.parametrize(("rate", "seed"), [(50.0, 2), (200.0, 5), (1000.0, 9)])
@pytest.mark.parametrize("start", [0.3, 0.7])
def test_a_torque_whose_sign_turns_is_told_with_the_time(start: float, rate: float, seed: int) -> None:
    log = joint_log(24.0, rate, seed)
    assert _changes(log) == []
    (said,) = _changes(_turn(log, start, 2.0))
    at = float(said.partition("--to ")[2].partition(" ")[0])
    assert at == pytest.approx(24.0 * start, abs=1.2)  # within a rest, no torque tells it
    assert _changes(_turn(_turn(log, start, 2.0), 0.0, 2.0)) != []  # turned before it instead


@pytest.mark.parametrize("seed", [1, 4])
def test_a_torque_that_turns_there_and_back_is_told_with_both_times(seed: int) -> None:
    (said,) = _changes(_turn(joint_log(30.0, 250.0, seed), 0.35, 0.6))
    times = [float(said.partition(f"{option} ")[2].partition(" ")[0].rstrip(";")) for option in ("--to", "--from")]
    assert times == pytest.approx([10.5, 18.0], abs=0.6)


@pytest.mark.parametrize("seed", [3, 6])
def test_what_follows_the_advice_has_one_sign(seed: int) -> None:
    log = _turn(joint_log(24.0, 500.0, seed), 0.5, 2.0)
    assert _changes(log)
    for part, flipped in ((log.window(0.0, 11.9), False), (log.window(12.1, 25.0), True)):
        codes = {one.code for one in check_recording(part)}
        assert "sign_change" not in codes
        assert ("flipped_torque" in codes) is flipped


@pytest.mark.parametrize("seed", [2, 7])
def test_gravity_that_turns_with_a_neighbour_and_a_change_of_size_are_none(seed: int) -> None:
    log = joint_log(24.0, 250.0, seed)
    later = np.asarray(log.time) >= 12.0
    gravity = 3.0 * np.cos(log.position)
    assert _changes(log.with_channels(torque=log.torque + np.where(later, -gravity, gravity))) == []
    assert _changes(log.with_channels(torque=np.where(later, 2.5, 1.0) * log.torque)) == []
    assert _changes(log.with_channels(torque=-np.asarray(log.torque))) == []


def test_what_a_turned_sign_explains_is_not_told_beside_it() -> None:
    log = joint_log(24.0, 250.0, 3)
    (found,) = [one.code for one in check_recording(_turn(log, 0.3, 2.0)) if one.severity == "error"]
    assert found == "sign_change"


@pytest.mark.parametrize(("push", "start"), [(-2.0, 4.0), (2.0, 9.0)])
def test_a_push_that_moves_the_joint_turns_no_sign(push: float, start: float) -> None:
    """Friction seems to drive while somebody pushes: a recording of 20 s with a push of 1.3 s had been refused."""
    log = joint_log(24.0, 250.0, 5)
    time = np.asarray(log.time)
    pushed = log.torque + push * ((time > start) & (time < start + 1.0))
    assert _changes(log.with_channels(torque=pushed)) == []
