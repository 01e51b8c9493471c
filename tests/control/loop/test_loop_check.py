"""The loop check: known oscillations are found, and the simulation behind it truly sticks."""

from __future__ import annotations

from math import nan

import numpy as np
import pytest

from fricomp.control import DriveLimits, LoopDynamics, check_loop
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.curve import split_law
from fricomp.control.compensation.limit_cycle import find_oscillation
from fricomp.control.loop.loop_simulation import LoopCases, simulate_loop
from fricomp.errors import ParameterError
from fricomp.laws import BidirectionalStribeck, Cogging, Coulomb, FrictionLaw, LuGre, StribeckCurve, Viscous
from fricomp.model import FrictionModel, Validity

FALLING = FrictionModel(
    FrictionLaw((BidirectionalStribeck(StribeckCurve(0.15, 0.6, 0.05, 0.02), StribeckCurve(0.2, 0.7, 0.05, 0.03)),)),
    validity=Validity(velocity=(-1.0, 1.0)),
)
LINEAR = FrictionModel(FrictionLaw((Viscous(0.5),)), validity=Validity(velocity=(-1.0, 1.0)))


def pd_loop(bandwidth: float, delay: float) -> LoopDynamics:
    omega = 2.0 * np.pi * bandwidth
    return LoopDynamics(0.05, 0.05 * omega**2, 0.1 * omega, delay)


@pytest.mark.parametrize(("factor", "stable"), [(0.9, True), (1.1, False)])
def test_delay_margin_of_a_linear_loop_is_found(factor: float, stable: bool) -> None:
    loop = pd_loop(5.0, 0.0)
    # L(jw) = (K + jwD)/(-Jw^2 + jwF) crosses 1 where its magnitude does; the delay margin is phase over frequency.
    omega = np.linspace(1.0, 500.0, 200_000)
    open_loop = (loop.stiffness + 1j * omega * loop.damping) / (-loop.inertia * omega**2 + 1j * omega * 0.5)
    crossing = int(np.argmin(np.abs(np.abs(open_loop) - 1.0)))
    margin = (np.pi + np.angle(open_loop[crossing])) / omega[crossing]
    settings = choose_settings(LINEAR, gain=0.0)
    delayed = LoopDynamics(loop.inertia, loop.stiffness, loop.damping, factor * margin)
    found = find_oscillation(split_law(LINEAR.law), delayed, settings, np.array([0.0]))
    assert bool(found.at_gains[0]) is not stable


def test_stick_slip_without_compensation_is_found_by_both_ways() -> None:
    check = check_loop(FALLING, pd_loop(5.0, 0.001))
    assert check.sticks_without
    assert check.scan.predicted[0] == check.scan.simulated[0] == 1.0
    assert not check_loop(FALLING, pd_loop(20.0, 0.0)).sticks_without


def test_prediction_and_simulation_agree_up_to_the_gain_in_use() -> None:
    for bandwidth, delay in ((5.0, 0.001), (10.0, 0.0035)):
        check = check_loop(FALLING, pd_loop(bandwidth, delay))
        used = check.scan.gain <= 1.15 * check.settings.gain
        assert np.mean(check.scan.predicted[used] == check.scan.simulated[used]) > 0.8


def test_loop_too_slow_for_its_delay_is_not_safe() -> None:
    check = check_loop(FALLING, pd_loop(10.0, 0.012))
    assert not check.is_safe
    assert check.margin == 0.0
    assert check.safe_gain == 0.0


def test_resting_joint_never_drifts() -> None:
    curves, still = split_law(FALLING.law), np.zeros(1500)
    for source in ("reference", "blend", "measured"):
        settings = choose_settings(FALLING, source=source, velocity_quantum=0.0147)
        cases = LoopCases(pd_loop(5.0, 0.0), np.full(3, 0.98), np.ones(3), np.full(3, 0.002), velocity_quantum=0.0147)
        start = np.array([0.0, 0.05, -0.3])
        done = simulate_loop(curves, settings, cases, (still, still), start_velocity=start)
        assert np.ptp(done.position[500:], axis=0) == pytest.approx(0.0, abs=1e-9)


def test_simulated_joint_holds_below_breakaway_and_slides_on_its_curve() -> None:
    curves, n = split_law(FrictionLaw((Coulomb(0.5), Viscous(0.1)))), 400
    loop = LoopDynamics(0.05, 10.0, 1.0)
    cases = LoopCases(loop, np.zeros(2), np.ones(2), np.zeros(2))
    settings = choose_settings(FrictionModel(FrictionLaw((Coulomb(0.5), Viscous(0.1)))))
    offset = np.array([0.049, 0.5])  # a spring torque of 0.49, below breakaway, and of 5
    reference = np.zeros((n, 2)) + np.concatenate([[0.0 * offset], np.tile(offset, (n - 1, 1))])
    done = simulate_loop(curves, settings, cases, (reference, np.zeros((n, 2))))
    assert np.all(done.position[:, 0] == 0.0)
    assert done.position[-1, 1] == pytest.approx(0.5, abs=0.051)  # it stops within F_c/K


def test_perfect_compensation_leaves_the_linear_loop() -> None:
    loop = pd_loop(5.0, 0.0)
    model = FrictionModel(FrictionLaw((Viscous(0.5),)), validity=Validity(velocity=(-9.0, 9.0)))
    settings = choose_settings(model, source="reference")
    cases = LoopCases(loop, np.array([1.0]), np.array([1.0]), np.zeros(1))
    time = np.arange(0.0, 2.0, 1e-3)
    done = simulate_loop(split_law(model.law), settings, cases, (0.3 * time, np.full_like(time, 0.3)))
    assert done.velocity[-1, 0] == pytest.approx(0.3, abs=1e-3)


def test_drive_too_slow_for_its_loop_is_found_and_the_compensation_has_no_part_in_it() -> None:
    slow = check_loop(FALLING, pd_loop(10.0, 0.004), drive=DriveLimits(5.0, 100.0))
    assert slow.unsettled_from <= 0.1
    assert slow.unsettled_without <= slow.unsettled_from
    assert not slow.is_safe
    assert check_loop(FALLING, pd_loop(5.0, 0.001)).unsettled_from == float("inf")


def test_simulated_torque_keeps_to_the_drive() -> None:
    curves, still = split_law(FALLING.law), np.zeros(50)
    settings = choose_settings(FALLING)
    cases = LoopCases(pd_loop(5.0, 0.0), np.zeros(1), np.ones(1), np.zeros(1), drive=DriveLimits(1.0, 200.0))
    done = simulate_loop(curves, settings, cases, (still, still), start_offset=-2.0)
    push = np.diff(done.velocity[:, 0]) / 1e-3 * 0.05
    assert push[:3] == pytest.approx(0.0, abs=1e-9)  # 0.2 N·m more every period: the joint sticks below 0.6
    assert np.max(push) <= 1.0


def test_terms_that_the_check_does_not_know_are_named() -> None:
    model = FrictionModel(FrictionLaw((*LINEAR.law.terms, Cogging(0.1, 0.0, 5.0))), validity=LINEAR.validity)
    assert check_loop(model, pd_loop(5.0, 0.001)).left_out == ("cogging",)


def test_the_bristle_of_a_dynamic_law_is_named_as_left_out() -> None:
    (curves,) = FALLING.law.terms
    assert isinstance(curves, BidirectionalStribeck)
    dynamic = FrictionModel(FrictionLaw((LuGre(curves.forward, curves.reverse, 1e4, 10.0),)), validity=FALLING.validity)
    assert check_loop(dynamic, pd_loop(5.0, 0.001)).left_out == ("bristle",)


@pytest.mark.parametrize("given", [{"torque": 0.0}, {"torque_rate": -1.0}, {"torque": float("nan")}])
def test_limits_of_a_drive_are_positive(given: dict[str, float]) -> None:
    with pytest.raises(ParameterError, match="positive"):
        DriveLimits(**given)


def test_check_needs_a_position_loop() -> None:
    with pytest.raises(ParameterError, match="stiffness"):
        check_loop(FALLING, LoopDynamics(0.1, 0.0, 1.0))


@pytest.mark.parametrize(
    ("period", "quantum", "words"), [(0.0, 0.0, "period"), (nan, 0.0, "period"), (1e-3, -1.0, "step")]
)
def test_check_refuses_times_and_steps_that_are_none(period: float, quantum: float, words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        check_loop(LINEAR, pd_loop(5.0, 0.001), period=period, velocity_quantum=quantum)
