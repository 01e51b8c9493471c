"""A torque whose size changes within a log is named with its time; warming, payloads and load friction are none."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Finding, Recording, check_recording
from fricomp.recording.checks import checks
from fricomp.recording.checks.torque_step import locate_torque_step

from ..joint_log import COULOMB, VISCOUS, joint_log


def _enlarge(log: Recording, start: float, factor: float) -> Recording:
    """The log with its torque multiplied from one part of its time on."""
    part = np.linspace(0.0, 1.0, len(log), endpoint=False)
    return log.with_channels(torque=np.where(part >= start, factor, 1.0) * np.asarray(log.torque))


def _list_codes(log: Recording) -> list[str]:
    return [one.code for one in check_recording(log) if one.code in ("gain_change", "friction_step")]


def _friction(log: Recording) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    velocity = np.gradient(log.position, log.time)
    return np.asarray(COULOMB * np.sign(velocity) + VISCOUS * velocity)


@pytest.mark.parametrize(("rate", "seed"), [(50.0, 2), (200.0, 5), (1000.0, 9)])
@pytest.mark.parametrize(("start", "factor"), [(0.3, 1.7), (0.6, 0.5), (0.75, 4.0)])
def test_a_torque_that_changes_its_size_is_told_with_time_and_factor(
    start: float, factor: float, rate: float, seed: int
) -> None:
    log = joint_log(30.0, rate, seed)
    assert _list_codes(log) == []
    step = locate_torque_step(_enlarge(log, start, factor))
    assert step is not None
    assert step.is_gain
    assert step.factor == pytest.approx(factor, rel=0.05)
    assert step.before - 0.5 < 30.0 * start < step.after + 0.5


def test_the_advice_cuts_the_log_into_parts_with_one_size() -> None:
    log = _enlarge(joint_log(30.0, 250.0, 4), 0.5, 1.6)
    (found,) = [one for one in check_recording(log) if one.severity == "error"]
    assert found.code == "gain_change"
    to, start = (
        float(found.advice.partition(f"{option} ")[2].split(",")[0].split(")")[0]) for option in ("--to", "--from")
    )
    assert _list_codes(log.window(0.0, to)) == []
    assert _list_codes(log.window(start, 31.0)) == []


@pytest.mark.parametrize("seed", [1, 6])
def test_two_logs_glued_at_a_gap_are_told(seed: int) -> None:
    log = _enlarge(joint_log(30.0, 250.0, seed), 0.5, 0.6)
    later = np.asarray(log.time) >= 15.0
    glued = log.with_channels(time=np.asarray(log.time) + np.where(later, 240.0, 0.0))
    assert "gain_change" in _list_codes(glued)


@pytest.mark.parametrize("seed", [1, 6, 8])
@pytest.mark.parametrize("settles", [0.08, 0.4])
def test_friction_that_warms_up_is_none(settles: float, seed: int) -> None:
    log = joint_log(30.0, 250.0, seed)
    part = np.linspace(0.0, 1.0, len(log))
    lost = 0.4 * (1.0 - np.exp(-part / settles))
    assert _list_codes(log.with_channels(torque=np.asarray(log.torque) - lost * _friction(log))) == []


@pytest.mark.parametrize("seed", [1, 6, 8])
@pytest.mark.parametrize("share", [0.0, 0.2])
def test_a_payload_that_comes_on_with_its_own_friction_is_none(share: float, seed: int) -> None:
    log = joint_log(30.0, 250.0, seed)
    later = np.linspace(0.0, 1.0, len(log)) > 0.45
    velocity = np.gradient(log.position, log.time)
    weight = np.where(later, 1.8, 1.0) * 3.0 * np.cos(log.position)
    load = (
        weight
        + share * np.abs(weight) * np.sign(velocity)
        + np.where(later, 0.1, 0.0) * np.gradient(velocity, log.time)
    )
    assert "gain_change" not in _list_codes(log.with_channels(torque=np.asarray(log.torque) + load))


@pytest.mark.parametrize("seed", [3, 7])
def test_friction_alone_that_steps_is_told_as_such(seed: int) -> None:
    log = joint_log(30.0, 250.0, seed)
    later = np.linspace(0.0, 1.0, len(log)) > 0.5
    assert _list_codes(log.with_channels(torque=np.asarray(log.torque) + later * _friction(log))) == ["friction_step"]


@pytest.mark.parametrize("torque", [0.0, 1.5])
def test_a_torque_without_any_change_is_none(torque: float) -> None:
    log = joint_log(30.0, 250.0, 3)
    assert locate_torque_step(log.with_channels(torque=np.full(len(log), torque))) is None


def test_a_part_without_torque_is_no_other_size_of_it() -> None:
    log = joint_log(30.0, 250.0, 3)
    assert locate_torque_step(_enlarge(log, 0.4, 1e-3)) is None


def test_a_joint_without_any_noise_has_none_but_its_own() -> None:
    log = joint_log(30.0, 250.0, 3)
    velocity = 2.0 * np.cos(np.asarray(log.time))
    exact = log.with_channels(position=2.0 * np.sin(np.asarray(log.time)), torque=0.4 * np.sign(velocity) + velocity)
    bare = Recording.from_channels(
        {name: exact.channels[name] for name in ("time", "position", "torque")}, log.metadata
    )
    assert locate_torque_step(bare) is None
    step = locate_torque_step(_enlarge(bare, 0.5, 2.0))
    assert step is not None
    assert step.factor == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize(("seed", "period"), [(8, 0.004), (64, 0.004), pytest.param(76, 0.004, marks=pytest.mark.slow)])
def test_strokes_at_several_speeds_by_a_coarse_encoder_are_no_step(seed: int, period: float) -> None:
    """The acceleration is the encoder's noise in slow strokes, and the joint's in fast ones."""
    rng = np.random.default_rng(seed)
    speeds = rng.permutation(np.geomspace(0.15, 1.8, 6))
    wanted = np.concatenate([np.repeat([speed, -speed], int(1.6 / speed / period)) for speed in speeds])
    velocity = np.convolve(wanted, np.ones(60) / 60.0, mode="same")
    torque = 2.8 * np.tanh(velocity / 1e-3) + 1.4 * velocity + 0.2 * np.gradient(velocity, period)
    torque = np.asarray(np.round(torque + rng.normal(0.0, 0.03, velocity.size), 2), dtype=np.float64)
    time = np.asarray(period * np.arange(velocity.size), dtype=np.float64)
    log = Recording(time, np.round(period * np.cumsum(velocity), 2), torque)
    assert _list_codes(log) == []


@pytest.mark.parametrize(("rate", "seed"), [(80.0, 11), (400.0, 13)])
@pytest.mark.parametrize("factors", [(1.4, 1.0), (0.7, 1.3)])
def test_a_torque_that_changes_twice_is_told_with_both_times(
    factors: tuple[float, float], rate: float, seed: int
) -> None:
    log = joint_log(45.0, rate, seed)
    part = np.linspace(0.0, 1.0, len(log), endpoint=False)
    size = np.select([part < 0.35, part < 0.65], [1.0, factors[0]], factors[1])
    log = log.with_channels(torque=size * np.asarray(log.torque))
    (found,) = [one for one in check_recording(log) if one.code == "gain_change"]
    assert found.message.count("times as large from") == 2
    to, between, start = found.advice.partition("(")[2].partition(")")[0].split(", ")
    begin, end = (float(one) for one in between.removeprefix("--from ").split(" --to "))
    for piece in (
        log.window(0.0, float(to.removeprefix("--to "))),
        log.window(begin, end),
        log.window(float(start.removeprefix("--from ")), 46.0),
    ):
        assert _list_codes(piece) == []


def test_a_recording_is_looked_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    log, looks = joint_log(6.0, 100.0, 5), list[Recording]()
    whole = checks._look_for_all

    def look(one: Recording) -> tuple[Finding, ...]:
        looks.append(one)
        return whole(one)

    monkeypatch.setattr(checks, "_look_for_all", look)
    assert check_recording(log) is check_recording(log)
    check_recording(log.with_channels(velocity=None))
    assert [one is log for one in looks] == [True, False]
