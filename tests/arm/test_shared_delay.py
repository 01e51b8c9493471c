"""A delay of all torques is taken off where joints agree on it; a few joints do not make it that of all."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from fricomp.arm import examine_arm
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.friction import JointForm
from fricomp.arm.prior import ArmPrior
from fricomp.arm.search import shared_delay
from fricomp.arm.search.shared_delay import (
    SharedDelay,
    agree,
    are_others_early,
    find_agreeing,
    measure_delay,
    measure_seen,
    share_delays,
    take_median,
)
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm

_LEVELS = (1.2, 0.8, 0.3)


def test_joints_with_one_delay_agree() -> None:
    delays = 6e-3 + 1e-3 * np.random.default_rng(0).normal(size=6)
    assert agree(delays, np.full(6, 1e-3))
    assert agree(delays[:1], np.full(1, 1e-6))


def test_joints_that_differ_ask_for_no_common_delay() -> None:
    """Three joints whose motion an elastic gear bends, and three that it does not."""
    delays = 1e-3 * np.array([-3.6, -4.0, -5.0, -0.6, -1.3, -1.0])
    spread = 1e-3 * np.array([1.1, 0.6, 0.7, 1.6, 1.4, 1.2])
    assert not agree(delays, spread)
    kept = find_agreeing(delays, spread)
    for some in (kept, slice(None)):
        assert not SharedDelay(*take_median(delays[some], spread[some]), {0: 0.0}).is_sure


def test_one_joint_does_not_move_what_most_ask_for() -> None:
    delays, spread = 1e-3 * np.array([6.0, 6.1, 5.9, 6.0, 6.1, -2.0]), np.full(6, 1e-4)
    assert not agree(delays, spread)
    found = SharedDelay(*take_median(delays, spread), {5: -2e-3})
    assert found.value == pytest.approx(6e-3, abs=1e-4)
    assert found.is_sure


def test_joints_apart_have_to_be_surer() -> None:
    assert SharedDelay(0.005, 0.002, {}).is_sure
    assert not SharedDelay(0.005, 0.002, {0: 0.009, 1: 0.001}).is_sure


@pytest.mark.parametrize(("third", "torn"), [(10e-3, True), (0.8e-3, False)])
def test_joints_that_surely_differ_are_torn(monkeypatch: pytest.MonkeyPatch, third: float, torn: bool) -> None:
    """A delay of all is then held: left to the fit it is that of the joint whose torque tells most."""
    asked = np.arange(3), np.array([0.0, 0.1e-3, third]), np.full(3, 0.2e-3)
    monkeypatch.setattr(shared_delay, "_ask_joints", lambda *_: asked)
    monkeypatch.setattr(shared_delay, "Glance", lambda *_: None)
    found = measure_delay(cast(Any, None), cast(Any, None), ArmPrior())
    assert found.apart
    assert found.is_torn is torn


def test_a_long_delay_is_found_in_few_steps_though_each_look_sees_half_of_it() -> None:
    truth, delay, moved, before = 0.010, 0.0, 0.0, 0.0
    for _ in range(3):
        more = 0.5 * (truth - delay)
        moved, before = more / measure_seen(more, before, moved), more
        delay += moved
    assert delay == pytest.approx(truth, abs=1e-6)
    assert measure_seen(1e-3, 1e-3, 1e-3) == pytest.approx(1.0 / 3.0)  # no fall: a step is no longer than three looks


def test_a_delay_that_most_joints_have_is_one_of_all() -> None:
    plain, late = JointForm(), JointForm().with_term("torque_delay", 0)
    assert share_delays(ArmModel((late, late, plain))) == ArmModel((plain, plain, plain))
    assert share_delays(ArmModel((late, plain, plain))) == ArmModel((late, plain, plain))


@pytest.mark.parametrize(
    ("asked", "taken"),
    [((5e-3, 3.5e-3, 9.7e-3), 3.5e-3), ((5e-3, 1e-3, 9.7e-3), 0.0), ((-5e-3, -3.5e-3), 0.0), ((5e-3, -3.5e-3), 0.0)],
)
def test_joints_that_are_all_late_are_as_late_as_the_least_of_them(asked: tuple[float, ...], taken: float) -> None:
    found = SharedDelay(0.0, 1.6e-3, dict(enumerate(asked)), 4e-4)
    assert found.take_least().value == taken


@pytest.mark.parametrize(("others", "early"), [((-1.4e-3, -0.7e-3), True), ((-1.4e-3, 0.0), False)])
def test_joints_may_all_ask_for_early_torques(
    monkeypatch: pytest.MonkeyPatch, others: tuple[float, float], early: bool
) -> None:
    asked = np.array([1, 2]), np.array(others), np.full(2, 1.5e-4)
    monkeypatch.setattr(shared_delay, "_ask_joints", lambda *_: asked)
    assert are_others_early(cast(Any, None), cast(Any, None), 0) is early


def test_one_joint_that_is_late_beside_others_leaves_them_their_delay(tmp_path: Path) -> None:
    """Of three joints one that was 9 ms later left nothing sure; without any delay, rounded friction had a bristle."""
    simulation = write_arm(tmp_path)

    def round_off(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
        rounded: FloatArray = np.tanh(v / (0.05 * float(np.max(np.abs(v)))))
        return _LEVELS[joint] * (rounded - np.sign(v))

    recordings = record_arm(simulation, round_off, rate=100.0, delay=3e-3, noise=0.01)
    time, torque = recordings[2].time, np.asarray(recordings[2].torque)
    recordings[2] = recordings[2].with_channels(torque=np.interp(time - 9e-3, time, torque))
    record = examine_arm(recordings, simulation).record
    assert record.delay.value == pytest.approx(3e-3, abs=1e-3)
    assert [[one.name for one in joint.effects] for joint in record.joints] == [[], [], ["torque_delay"]]


@pytest.mark.slow
@pytest.mark.parametrize("later", [10e-3, 16e-3])
def test_one_joint_that_is_late_beside_bristles_has_a_delay(tmp_path: Path, later: float) -> None:
    """Its torque tells most, and had been taken for the time of all: by 16 ms its bristle had a ripple for it."""
    simulation = write_arm(tmp_path)

    def build_up(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
        bent, turned, way = 0.0, np.empty_like(v), 2e-3 * float(np.max(np.abs(v)))
        for k, rate in enumerate(v.tolist()):
            bent = min(max(bent + rate / 250.0 * (1.0 - bent * np.sign(rate)) / way, -1.0), 1.0)
            turned[k] = bent
        return _LEVELS[joint] * (turned - np.sign(v))

    recordings = record_arm(simulation, build_up)
    time, torque = recordings[1].time, np.asarray(recordings[1].torque)
    recordings[1] = recordings[1].with_channels(torque=np.interp(time - later, time, torque))
    record = examine_arm(recordings, simulation).record
    names = [{one.name for one in joint.effects} for joint in record.joints]
    bristle = {"presliding_hysteresis"}
    assert names == [bristle, bristle | {"torque_delay"}, bristle]
    (delay,) = (one.parameters["delay"] for one in record.joints[1].effects if one.name == "torque_delay")
    assert delay.value == pytest.approx(later, abs=5e-4)


@pytest.mark.parametrize(
    ("delays", "expected"),
    [((-0.42, -0.47, 5.9), -0.445), ((-0.42, -0.47, -0.4, 8.0, 8.1, 8.2), 3.8)],
)
def test_joints_that_differ_from_most_say_nothing_of_the_time_of_all(
    delays: tuple[float, ...], expected: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    joints, asked = np.arange(len(delays)), 1e-3 * np.array(delays)
    monkeypatch.setattr(shared_delay, "_ask_joints", lambda *_: (joints, asked, np.full(len(delays), 1e-4)))
    monkeypatch.setattr(shared_delay, "Glance", lambda *_: None)
    found = measure_delay(*(cast(Any, None),) * 2, ArmPrior())
    assert found.value == pytest.approx(1e-3 * expected)
    assert found.is_torn
    assert len(found.apart) == len(delays)
    assert found.is_sure == (len(delays) == 3)
