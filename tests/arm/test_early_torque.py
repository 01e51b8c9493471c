"""One joint whose torque is recorded before those of the others, and elastic gears that look like it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fricomp.arm import ArmExamination, examine_arm
from fricomp.arm.comparison import delays
from fricomp.arm.comparison.delays import list_mistimed
from fricomp.arm.examination import match_recordings
from fricomp.arm.friction import JointForm
from fricomp.arm.identification import identify_arm
from fricomp.arm.search.early_torque import EarlyTorques
from fricomp.arm.search.judge import Estimate
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .moving_arm import bend_gear, record_arm, write_arm
from .test_examination import names_of

_ELBOW, _DURATION = 1, 20.0


def _shift(recordings: Sequence[Recording], delays: Sequence[float]) -> list[Recording]:
    """The same with torques that are later by these times [s]."""
    return [
        replace(one, torque=np.interp(one.time - delay, one.time, one.torque))
        for one, delay in zip(recordings, delays, strict=True)
    ]


def _is_early(found: ArmExamination, joint: int) -> bool:
    one = found.answer.identification
    return EarlyTorques(one.rows, one.equations, one.fit).holds(joint)


def test_a_torque_that_is_recorded_first_is_named_and_the_others_are_not(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    recordings = _shift(record_arm(simulation, duration=_DURATION), (0.008, 0.001, 0.008))
    found = examine_arm(recordings, simulation)
    assert names_of(found.record) == {"shoulder": [], "elbow": ["torque_delay"], "wrist": []}
    delay = found.record.joints[_ELBOW].effects[0].parameters["delay"]
    assert delay.ci95[0] <= -0.007 <= delay.ci95[1]
    assert found.record.delay.value == pytest.approx(0.008, abs=5e-4)
    assert "earlier than those of the other joints" in found.summary()
    assert "The torques of all joints but elbow are" in found.summary()
    assert [own for own, _ in found.answer.own_delays] == pytest.approx([0.0, -0.007, 0.0], abs=5e-4)


def test_a_later_one_is_said_to_be_later(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    found = examine_arm(_shift(record_arm(simulation, duration=_DURATION), (0.0, 0.006, 0.0)), simulation)
    assert names_of(found.record) == {"shoulder": [], "elbow": ["torque_delay"], "wrist": []}
    assert "later than those of the other joints" in found.summary()
    assert not _is_early(found, _ELBOW)


def test_a_command_through_a_drive_that_lags_is_a_torque_that_is_recorded_first(tmp_path: Path) -> None:
    """Where friction turns round, u = tau + T tau' is more than tau a little later. Friction that creeps drew the rest
    and took the place of the delay."""
    simulation, lag = write_arm(tmp_path), 0.011
    recordings = record_arm(simulation, duration=30.0)  # in less, the narrow band does not tell when it turns
    elbow = recordings[_ELBOW]
    recordings[_ELBOW] = replace(elbow, torque=elbow.torque + lag * np.gradient(_smooth(elbow.torque), elbow.time))
    found = examine_arm(recordings, simulation)
    assert names_of(found.record) == {"shoulder": [], "elbow": ["torque_delay"], "wrist": []}
    (effect,) = found.record.joints[_ELBOW].effects
    assert effect.parameters["delay"].value == pytest.approx(-lag, rel=0.1)
    assert "drive_lag" in effect.indistinguishable_from


def _smooth(torque: FloatArray) -> FloatArray:
    """Without the noise of single samples, which no drive has in its command."""
    return np.asarray(np.convolve(torque, np.full(5, 0.2), mode="same"))


@pytest.mark.parametrize("side", ["motor", "link"])
def test_an_elastic_gear_is_no_early_torque(tmp_path: Path, side: str) -> None:
    simulation = write_arm(tmp_path)
    bend = bend_gear(_ELBOW, stiffness=300.0, side=side)
    found = examine_arm(record_arm(simulation, duration=_DURATION, bend=bend), simulation)
    assert not any("torque_delay" in names for names in names_of(found.record).values())
    assert not any(_is_early(found, joint) for joint in range(3))


def test_all_torques_that_are_early_are_said_to_be_ahead(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    found = examine_arm(_shift(record_arm(simulation, duration=_DURATION), (-0.006, -0.006, -0.006)), simulation)
    assert found.record.delay.value == pytest.approx(-0.006, abs=5e-4)


def test_torques_ahead_by_less_than_a_held_command_are_moved_though_friction_turns_early(tmp_path: Path) -> None:
    """Rows of 4 ms hold a command for 2 ms in the mean; viscous friction came out 10 % too small."""

    def turn_early(joint: int, _: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
        return np.asarray((0.4, 0.25, 0.1)[joint] * (np.sign(np.roll(v, -1)) - np.sign(v)))

    simulation = write_arm(tmp_path)
    recordings = record_arm(simulation, turn_early, delay=-0.0015, duration=_DURATION)
    found = identify_arm(*match_recordings(recordings, simulation))
    assert found.delay.value == pytest.approx(-0.0015, abs=5e-4)
    assert found.fit.friction(0)["viscous"] == pytest.approx(0.6, rel=0.05)


def _measure(links: float, friction: float, deviation: float = 0.5) -> EarlyTorques:
    """Two joints whose links and friction ask for these times beside that of all, and how well that of links is known
    [ms]."""
    torques = EarlyTorques.__new__(EarlyTorques)
    torques._fit = SimpleNamespace(arm=SimpleNamespace(joints=("a", "b")))  # type: ignore[assignment]
    measured = Estimate(1e-3 * np.array([links, friction]), np.diag((1e-3 * np.array([deviation, 0.8])) ** 2))
    torques.measure = lambda _: measured  # type: ignore[assignment]
    return torques


@pytest.mark.parametrize(("links", "deviation", "early"), [(-6.0, 0.5, True), (-4.0, 4.0, False), (0.0, 0.5, False)])
def test_friction_that_turns_before_a_joint_moves_makes_no_torque_early(
    links: float, deviation: float, early: bool
) -> None:
    """Joints that stick turn their friction while they rest; only links that ask early as well make a torque early."""
    torques = _measure(links + 5.0, 4.5, deviation)
    torques._is_one = lambda _: True  # type: ignore[method-assign, assignment]
    assert torques.are_all(-5e-3) == early


@pytest.mark.parametrize(("links", "friction", "torn"), [(6.5, -3.7, True), (6.5, -1.0, False), (5.0, 6.0, False)])
def test_a_joint_whose_links_look_late_and_whose_friction_turns_early_has_no_delay(
    links: float, friction: float, torn: bool
) -> None:
    """Three of seven joints of an arm whose friction is MuJoCo's were told late, and all torques none for it."""
    assert _measure(links, friction).is_torn(0) == torn


@pytest.mark.parametrize(
    ("links", "friction", "held"), [(1.0, -6.0, True), (3.0, -6.0, False), (-1.0, 1.0, False), (-1.0, -3.0, True)]
)
def test_torques_are_held_where_links_ask_early_and_friction_earlier(links: float, friction: float, held: bool) -> None:
    """Beside 2.7 ms ahead; where links ask before friction turns, a gear gives way."""
    assert _measure(links, friction).are_held(-2.7e-3) == held


@pytest.mark.parametrize("term", ["backlash", "joint_elasticity"])
def test_a_joint_whose_gear_lets_its_link_go_has_no_early_torque(term: str) -> None:
    """Beside a gap that was found, links and friction asked for 5 ms more, and the joint was told to be early."""
    torques = _measure(-6.0, -6.0)
    torques._fit.model = SimpleNamespace(forms=(JointForm(((term, 0),)), JointForm()))  # type: ignore[misc, assignment]
    assert torques.holds(0)
    assert not torques.shows(0, None)  # type: ignore[arg-type]


@pytest.mark.slow
def test_links_that_ask_early_beside_friction_that_does_not_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a command through a drive that lags, of a joint that sticks: 12 ms, which are three rows. Not beside an
    encoder of 14 bits, whose steps the loop answers: healthy joints of two arms were told 10 ms early."""
    simulation = write_arm(tmp_path)

    def ahead(joint: int, _: FloatArray, __: FloatArray, rigid: FloatArray) -> FloatArray:
        return np.append(rigid[3:], rigid[-1:].repeat(3)) - rigid if joint == 2 else np.zeros_like(rigid)

    examined = examine_arm(record_arm(simulation, ahead), simulation)
    record, found = examined.record, examined.answer.identification
    times = [joint.link_delay for joint in record.joints]
    assert times[:2] == [None, None]
    assert times[2] is not None
    low, high = times[2].ci95
    assert low <= -0.012 <= high < -0.008
    assert record.summary[0].startswith("What the links ask for was recorded at another time than the rest, in wrist")
    assert record.summary[1].startswith("To do: log the torque that acts")
    noise = found.equations.weights.noise
    assert set(list_mistimed(found)) == {2}
    monkeypatch.setattr(delays, "compute_noise_torque", lambda *_: 0.6 * noise)
    assert list_mistimed(found) == {}
