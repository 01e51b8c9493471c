"""Friction that remembers: rests and lags in the compensator are those of the law, and stay within bounds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fricomp.control import Compensator, LoopDynamics, check_loop
from fricomp.laws import (
    BidirectionalStribeck,
    DwellStiction,
    FrictionLaw,
    KinematicError,
    LaggedLuGre,
    LaggedStribeck,
    LoadScaling,
    LuGre,
    OperatingPoint,
    StribeckCurve,
    Term,
    ThermalFriction,
)
from fricomp.model import FrictionModel, Validity

FORWARD, REVERSE = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
CORE = BidirectionalStribeck(FORWARD, REVERSE)
LAWS: dict[str, tuple[Term, ...]] = {
    "dwell": (CORE, DwellStiction(0.4, 0.3, 5e-3, 3e-3)),
    "lagged": (LaggedStribeck(FORWARD, REVERSE, lag=8e-3),),
    "lagged bristle": (LaggedLuGre(FORWARD, REVERSE, 500.0, 1.0, lag=8e-3),),
    "lagged and dwell": (LaggedStribeck(FORWARD, REVERSE, lag=8e-3), DwellStiction(0.4, 0.3, 5e-3, 3e-3)),
}
STATELESS: tuple[Term, ...] = (
    ThermalFriction(0.05, 0.08, 0.002, 0.001, 30.0),
    KinematicError(2e-3, -1e-3, 9.0, 0.3, 1.0, -0.5),
)


def make_model(*terms: Term) -> FrictionModel:
    ranges = Validity(velocity=(-1.0, 1.0), position=(-1.0, 1.0), temperature=(10.0, 60.0))
    return FrictionModel(FrictionLaw(terms), validity=ranges)


def draw_velocity(rows: int) -> list[float]:
    rng = np.random.default_rng(2)
    held = rng.choice([0.0, 1e-3, 0.02, 0.3, 0.9], rows // 25) * rng.choice([-1.0, 1.0], rows // 25)
    return [float(v) for v in np.repeat(held, 25)]


@pytest.mark.parametrize("name", LAWS)
def test_compensation_of_a_reference_is_the_law(name: str) -> None:
    model = make_model(*LAWS[name])
    compensator = Compensator(model, source="reference", gain=1.0, smoothing=1e-12, period=2e-3, authority=9.0)
    for _ in range(2):  # a reset forgets all
        state = model.law.rest_state()
        for velocity in draw_velocity(2000):
            expected, state = model.law.advance(state, OperatingPoint(velocity), 2e-3)
            torque = compensator.torque(velocity)
            if velocity or "lagged" not in name:  # while a lag still drags, rest is half way between both directions
                assert torque == pytest.approx(float(expected), rel=1e-9, abs=1e-12)
        compensator.reset()


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("source", ["reference", "blend", "measured"])
def test_any_finite_input_gives_a_torque_within_the_authority(name: str, source: str) -> None:
    model = make_model(*LAWS[name], *STATELESS)
    compensator = Compensator(model, source=source)
    rng = np.random.default_rng(6)
    for row in rng.normal(size=(2000, 6)) * 10.0 ** rng.uniform(-9.0, 305.0, size=(2000, 6)):
        v_ref, v, error, q, hot, a = (float(value) for value in row)
        torque = compensator.torque(v_ref, v, error, position=q, temperature=hot, acceleration=a)
        assert abs(torque) <= compensator.settings.authority
    fresh = Compensator(model, source=source)
    for _ in range(300):  # what was far off is forgotten in some lags and rests
        after, expected = (c.torque(0.5, 0.5, 0.0, position=0.1, acceleration=0.0) for c in (compensator, fresh))
    assert after == pytest.approx(expected, rel=1e-6)
    assert expected > 0.1


def test_a_joint_at_rest_gets_nothing_however_long_it_rests() -> None:
    compensator = Compensator(make_model(*LAWS["dwell"]), gain=1.0)
    assert {compensator.torque(0.0, 0.0, 0.0) for _ in range(5000)} == {0.0}


@pytest.mark.parametrize("source", ["reference", "blend", "measured"])
def test_rests_raise_the_torque_by_no_more_than_their_rise_and_as_smoothly(source: str) -> None:
    laws = (CORE,), LAWS["dwell"]
    plain, rested = (Compensator(make_model(*law), source=source, gain=1.0, smoothing=0.005) for law in laws)
    for _ in range(5000):
        plain.torque(0.0, 0.0)
        rested.torque(0.0, 0.0)
    for velocity in np.linspace(0.0, 0.1, 200):
        one, other = (c.torque(float(velocity), float(velocity)) for c in (plain, rested))
        assert -1e-12 <= other - one <= 0.4 * math.tanh(velocity / 0.005) + 1e-12


def test_authority_holds_what_rests_and_an_uneven_gear_may_ask_for() -> None:
    plain = Compensator(make_model(CORE)).settings.authority
    assert Compensator(make_model(*LAWS["dwell"])).settings.authority == pytest.approx(plain + 0.4)
    term = STATELESS[1]
    position, law = np.linspace(-4.0, 4.0, 2000), FrictionLaw((term,))
    settings = Compensator(make_model(CORE, term)).settings
    assert settings.acceleration_range is not None
    points = [(v, a) for v in (0.0, 1.0) for a in (0.0, *settings.acceleration_range)]
    worst = max(float(np.max(np.abs(law.torque(v, position=position, acceleration=a)))) for v, a in points)
    assert worst <= settings.authority - plain <= 2.0 * worst


@pytest.mark.parametrize("term", [LuGre, LaggedLuGre])
def test_under_a_load_beyond_all_bending_the_direction_changes_without_a_jump(term: type[LuGre]) -> None:
    late = {"lag": 8e-3} if term is LaggedLuGre else {}
    law = term(FORWARD, REVERSE, 6000.0, 1.0, load=LoadScaling(1.0, 0.01), **late)
    compensator = Compensator(make_model(law))
    assert [compensator.torque(v, normal_load=20.0) for v in (0.0, 1e-12, -1e-12)] == pytest.approx([0.0] * 3, abs=1e-6)
    assert compensator.torque(0.3, normal_load=20.0) == compensator.settings.authority


@pytest.mark.parametrize("name", ["lagged", "lagged bristle"])
def test_a_lag_makes_no_jump_of_viscous_friction_where_the_reference_changes_its_sign(name: str) -> None:
    torques = []
    for sign in (1.0, -1.0):
        compensator = Compensator(make_model(*LAWS[name]), source="reference", gain=1.0)
        for _ in range(200):
            compensator.torque(1.0)
        torques.append(compensator.torque(sign * 1e-12))
    assert torques[0] == pytest.approx(torques[1], abs=1e-6)
    assert torques[0] > 0.01


@pytest.mark.parametrize("wrong", [1e3, 1e200, 1e308])
@pytest.mark.parametrize("term", [LuGre, LaggedLuGre])
def test_a_wrong_load_bends_no_bristle_for_longer_than_it_lasts(term: type[LuGre], wrong: float) -> None:
    """The load has no range; steady sliding over less than 0.1 rad leaves nothing of it."""
    late = {"lag": 8e-3} if term is LaggedLuGre else {}
    law = term(FORWARD, REVERSE, 6000.0, 1.0, load=LoadScaling(1.0, 0.5), **late)
    hurt, sound = Compensator(make_model(law)), Compensator(make_model(law))
    assert hurt.torque(0.3, normal_load=wrong) in (0.0, hurt.settings.authority)
    for _ in range(300):
        after, expected = (c.torque(0.3, normal_load=0.5) for c in (hurt, sound))
    assert after == pytest.approx(expected, rel=1e-9)
    assert expected > 0.1


def test_the_loop_check_says_that_it_knows_no_lag() -> None:
    loop = LoopDynamics(inertia=0.1, stiffness=400.0, damping=13.0, delay=1e-3)
    checked = check_loop(make_model(*LAWS["lagged and dwell"]), loop)
    assert checked.left_out == ("dwell_stiction", "lag of friction")
