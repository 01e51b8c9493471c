"""Which law a recording is identified with where nobody names one."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import fricomp
from fricomp.api import motion_law
from fricomp.calibration.identification import Status
from fricomp.calibration.identification.doubt import doubted
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.laws import FloatArray
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import COULOMB, VISCOUS, joint_log


def _bent(seed: int) -> Recording:
    """A joint whose static torque is twice its Coulomb torque, moved slowly and fast by three sines."""
    time = np.arange(0.0, 24.0, 0.004)
    rates = 2.0 * np.pi * np.array([0.11, 0.31, 0.83])
    phases = np.outer(time, rates) + np.random.default_rng(seed).uniform(0.0, 6.0, 3)
    sizes = np.array([1.0, 0.3, 0.05])
    velocity: FloatArray = np.cos(phases) @ (sizes * rates)
    friction = np.sign(velocity) * (0.3 + 0.3 * np.exp(-((velocity / 0.2) ** 2))) + 0.1 * velocity
    torque = friction - 0.05 * np.sin(phases) @ (sizes * rates**2)
    noisy = torque + np.random.default_rng(seed + 1).normal(0.0, 0.005, time.size)
    return Recording(time, np.sin(phases) @ sizes, noisy)


@pytest.mark.parametrize(("rate", "seed"), [(160.0, 5), pytest.param(320.0, 6, marks=pytest.mark.slow)])
def test_a_joint_without_a_stribeck_effect_is_usable_by_the_plain_law(rate: float, seed: int) -> None:
    found = fricomp.identify(joint_log(14.0, rate, seed))
    assert found.is_usable, found.result.message
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(COULOMB, rel=0.01)
    assert found.parameters["viscous.viscous_coefficient"] == pytest.approx(VISCOUS, rel=0.02)
    assert any(note.startswith("Law: coulomb_viscous, which leaves no more") for note in found.notes)


@pytest.mark.parametrize(("rate", "seed"), [(200.0, 4), pytest.param(333.0, 7, marks=pytest.mark.slow)])
def test_a_joint_that_drags_more_one_way_is_usable_by_a_straight_line_for_each(rate: float, seed: int) -> None:
    log = joint_log(16.0, rate, seed)
    assert log.velocity is not None
    dragged = np.asarray(log.torque) + 0.5 * VISCOUS * np.minimum(log.velocity, 0.0)
    found = fricomp.identify(log.with_channels(torque=dragged))
    assert found.is_usable, found.result.message
    for direction, viscous in (("forward", VISCOUS), ("reverse", 1.5 * VISCOUS)):
        assert found.parameters[f"stribeck.{direction}.coulomb_torque"] == pytest.approx(COULOMB, rel=0.02)
        assert found.parameters[f"stribeck.{direction}.viscous_coefficient"] == pytest.approx(viscous, rel=0.05)
    assert found.model.reverse.static_torque == found.parameters["stribeck.reverse.coulomb_torque"]
    assert any(note.startswith("Law: asymmetric_coulomb_viscous, which") for note in found.notes)


@pytest.mark.slow
def test_a_law_that_was_asked_for_is_kept() -> None:
    found = fricomp.identify(joint_log(20.0, 200.0, 5), law="stribeck")
    assert any(name.endswith("static_torque") for name in found.parameters)
    assert not found.is_usable


def test_a_stribeck_effect_that_shows_is_identified_with_its_law() -> None:
    found = fricomp.identify(_bent(3))
    assert found.is_usable, found.result.message
    assert found.model.forward.static_torque == pytest.approx(0.6, rel=0.05)
    assert not any(note.startswith("Law: ") for note in found.notes)


def test_a_viscous_coefficient_at_its_bound_is_no_measured_value() -> None:
    log = joint_log(20.0, 250.0, 8)
    assert log.velocity is not None
    falling = np.asarray(log.torque) - 1.3 * VISCOUS * np.asarray(log.velocity)
    found = fricomp.identify(log.with_channels(torque=falling), law="coulomb_viscous")
    assert found.parameters["viscous.viscous_coefficient"] < 1e-6
    assert any("viscous.viscous_coefficient is at the bound, zero, and no measured value" in one for one in found.notes)
    whole = fricomp.identify(log, law="coulomb_viscous")
    assert not any("at the bound" in one for one in whole.notes)


def _move_at(speeds: list[float], seed: int, noise: float = 0.005) -> Recording:
    """The joint of `_bent` at constant speeds, one after the other for 0.8 s each."""
    window = np.hanning(51) / np.hanning(51).sum()
    steps = np.repeat(speeds, 200)
    time: FloatArray = 0.004 * np.arange(steps.size, dtype=np.float64)
    velocity: FloatArray = np.convolve(np.pad(steps, 25, mode="edge"), window, mode="valid")
    friction = np.sign(velocity) * (0.3 + 0.3 * np.exp(-((velocity / 0.2) ** 2))) + 0.1 * velocity
    noisy = friction + np.random.default_rng(seed).normal(0.0, noise, time.size)
    position: FloatArray = np.cumsum(velocity) * 0.004
    return Recording(time, position, noisy + 0.05 * np.gradient(velocity, time))


@pytest.mark.slow
def test_one_curve_of_both_directions_is_given_where_that_of_one_is_not_determined() -> None:
    found = fricomp.identify(_move_at([1.8, -0.06, 2.1, -0.15, 1.95, -0.3, 2.3, -0.1, 1.7, -0.9], 1, 0.06))
    assert found.is_usable, found.result.message
    assert any(note.startswith("Law: symmetric_stribeck, which leaves no more") for note in found.notes)
    assert found.parameters["symmetric_stribeck.curve.static_torque"] == pytest.approx(0.6, rel=0.1)
    assert found.parameters["symmetric_stribeck.curve.coulomb_torque"] == pytest.approx(0.3, rel=0.1)


def test_a_motion_in_one_direction_gives_the_sum_of_friction_and_offset() -> None:
    one_way = _move_at([0.9, 1.6, 0.8, 2.0, 1.2, 0.7] * 2, 2)
    found = fricomp.identify(one_way.with_channels(torque=one_way.torque + 0.2))
    assert not found.is_usable
    assert "record both directions" in found.result.message
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("little", "usable"), [(0.02, True), (0.0, False)])
def test_a_plain_law_that_leaves_little_is_taken_where_no_other_is_determined(
    little: float, usable: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(motion_law, "_is_as_good", lambda *_, **__: False)
    monkeypatch.setattr(motion_law, "_LITTLE", little)
    found = fricomp.identify(joint_log(14.0, 160.0, 5))
    assert found.is_usable is usable
    assert any(note.startswith("Law: coulomb_viscous, which is close above") for note in found.notes) is usable


@pytest.mark.parametrize(
    ("plain", "usual", "close"), [(0.026, 0.0225, True), (0.026, 0.003, False), (0.02, 0.03, True)]
)
def test_what_a_plain_law_leaves_is_counted_beyond_the_noise(plain: float, usual: float, close: bool) -> None:
    """A healthy joint with noise of 2 % of its friction ended as not usable, for a bend below its slowest speed."""
    points = np.array([[0.2, 1.0], [1.0, 1.2], [-0.2, -0.9], [-1.0, -0.9]])
    fits = [
        SimpleNamespace(friction=SimpleNamespace(noise=SimpleNamespace(level=one)), points=points)
        for one in (plain, usual)
    ]
    assert motion_law._is_close(*fits) is close  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_plainer_law_is_tried_where_a_second_basin_is_nearly_as_likely(monkeypatch: pytest.MonkeyPatch) -> None:
    def suspect(*args: Any, **options: Any) -> MotionIdentification:
        found = identify_motion(*args, **options)
        if options["law"] != motion_law.USUAL_LAW:
            return found
        return replace(found, friction=doubted(found.friction, Status.WRONG_BASIN_SUSPECTED, "a second basin"))

    monkeypatch.setattr(motion_law, "identify_motion", suspect)
    found = fricomp.identify(joint_log(14.0, 160.0, 5))
    assert set(found.parameters) == {"coulomb.coulomb_torque", "viscous.viscous_coefficient"}


@pytest.mark.parametrize(
    ("static", "velocity", "why"),
    [
        (0.39, 0.3, "the static torque is below the Coulomb torque"),
        (0.65, 0.08, "the bend lies below the slowest speed of 0.2"),
        (0.65, 0.3, ""),
    ],
)
def test_a_bend_that_no_speed_shows_is_told(static: float, velocity: float, why: str) -> None:
    """Trapezoids pass the slow speeds in a few samples, which the low-pass mixes with the rest before them."""
    curve = {"static_torque": static, "coulomb_torque": 0.5, "stribeck_velocity": velocity, "viscous_coefficient": 0.1}
    parameters = {f"stribeck.{way}.{name}": value for way in ("forward", "reverse") for name, value in curve.items()}
    points = np.array([[0.2, 0.5], [1.0, 0.6], [-0.2, -0.5], [-1.0, -0.6]])
    found = SimpleNamespace(friction=SimpleNamespace(parameters=parameters), points=points)
    said = motion_law._describe_unseen_bend(cast(MotionIdentification, found))
    assert said.startswith(why)
    assert bool(said) is bool(why)


def test_degrees_are_named_ahead_of_what_they_look_like() -> None:
    """Gravity over positions of many turns bends the torque as a spring would."""
    log = joint_log(20.0, 250.0, 4)
    angle, speed = 60.0 * np.asarray(log.position), 60.0 * np.asarray(log.velocity)
    bent = np.asarray(log.torque) + 2.0 * np.sin(np.asarray(log.position))
    found = fricomp.identify(Recording(np.asarray(log.time), angle, bent, velocity=speed, metadata=log.metadata))
    assert not found.is_usable
    assert "it seems to be in degrees (factor 57.3); multiply by π/180" in found.result.message


@pytest.mark.parametrize(("seed", "period"), [(2, 0.005), pytest.param(8, 0.004, marks=pytest.mark.slow)])
def test_an_inertia_of_which_noise_is_all_that_is_seen_makes_no_noise_of_friction(seed: int, period: float) -> None:
    """Strokes at constant speeds, written with two decimals: the acceleration is that of rounding."""
    rng = np.random.default_rng(seed)
    speeds = rng.permutation(np.geomspace(0.15, 1.8, 6))
    wanted = np.concatenate([np.repeat([speed, -speed], int(1.6 / speed / period)) for speed in speeds])
    velocity = np.convolve(wanted, np.ones(60) / 60.0, mode="same")
    time = period * np.arange(velocity.size)
    position = period * np.cumsum(velocity)
    torque = 2.8 * np.tanh(velocity / 1e-3) + 1.4 * velocity + 0.2 * np.gradient(velocity, period)
    log = Recording(np.round(time, 3), np.round(position, 2), np.round(torque + rng.normal(0.0, 0.03, time.size), 2))
    found = fricomp.identify(log)
    assert found.is_usable, found.result.message
    assert found.result.noise.level < 0.1
    for speed in (0.3, 1.2):
        assert float(found.model.torque(speed)) == pytest.approx(2.8 + 1.4 * speed, rel=0.03)
