"""Terms of effects that a diagnosis names, against their laws computed in another way."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fricomp.errors import ParameterError
from fricomp.laws import (
    Cogging,
    DwellStiction,
    DynamicTerm,
    EndStop,
    FloatArray,
    FrictionLaw,
    KinematicError,
    LaggedLuGre,
    LaggedStribeck,
    LuGre,
    OperatingPoint,
    PositionCoulomb,
    SpringTorque,
    StribeckCurve,
    Term,
    ThermalFriction,
    ThermalViscous,
)
from fricomp.model import FrictionModel, decode_model, encode_model

FORWARD, REVERSE = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
THERMAL = ThermalFriction(0.5, 0.8, 0.02, 0.004, 30.0)
DWELL = DwellStiction(0.4, 0.3, 5e-3, 3e-3)
UNEVEN = KinematicError(2e-8, -1e-8, 30.0, 0.3, 1.0, -2.0)
LAGGED = LaggedStribeck(FORWARD, REVERSE, lag=8e-3)
LAGGED_LUGRE = LaggedLuGre(FORWARD, REVERSE, sigma_0=500.0, sigma_1=1.0, lag=8e-3)
STEP = 1e-3


def stepwise_motion(steps: int) -> FloatArray:
    """Velocities held for 20 samples each: rest, creep below a rest speed, and motion both ways."""
    rng = np.random.default_rng(3)
    sizes = rng.choice([0.0, 1e-3, 4e-3, 0.05, 0.4], size=steps // 20)
    return np.repeat(sizes * rng.choice([-1.0, 1.0], size=sizes.size), 20)


def advance(term: DynamicTerm, velocity: FloatArray) -> FloatArray:
    """Torque at the end of each step, from rest. Shape (n,)."""
    state, found = term.rest_state(), []
    for v in velocity:
        torque, state = term.advance(state, OperatingPoint(float(v)), STEP)
        found.append(float(torque))
    return np.array(found)


def solve(rate: Callable[[float, FloatArray], FloatArray], start: FloatArray, velocity: FloatArray) -> FloatArray:
    """State at the end of each step of constant velocity, by an integrator that knows no exact solution."""
    states, state = [], start
    for v in velocity:
        done = solve_ivp(lambda _, y, v=v: rate(v, y), (0.0, STEP), state, rtol=1e-9, atol=1e-12)
        state = done.y[:, -1]
        states.append(state)
    return np.array(states)


@pytest.mark.parametrize("velocity", [-0.7, -0.01, 0.02, 0.9])
@pytest.mark.parametrize("temperature", [5.0, 30.0, 55.0])
def test_thermal_friction_is_the_difference_of_two_friction_laws(velocity: float, temperature: float) -> None:
    beta_forward, beta_reverse, gamma = 0.02 / 0.5, 0.02 / 0.8, 0.004 / 2.0

    def friction(warmth: float) -> float:
        viscous, beta = (0.5, beta_forward) if velocity > 0.0 else (0.8, beta_reverse)
        return viscous * math.exp(-beta * warmth) * velocity + math.copysign(2.0 * (1.0 - gamma * warmth), velocity)

    found = float(FrictionLaw((THERMAL,)).torque(velocity, temperature=temperature))
    assert found == pytest.approx(friction(temperature - 30.0) - friction(0.0), rel=1e-12, abs=1e-15)


def test_thermal_friction_is_nothing_without_a_temperature_and_bounded_at_any() -> None:
    law = FrictionLaw((THERMAL,))
    assert law.torque(0.4) == 0.0
    viscous_only = FrictionLaw((ThermalFriction(0.5, 0.8, 0.02, 0.0, 30.0),))
    assert viscous_only.torque(1.0, temperature=-1e9) == pytest.approx(0.5 * math.expm1(3.0))
    assert viscous_only.torque(-1.0, temperature=1e9) == pytest.approx(0.8 * (1.0 - math.exp(-3.0)))


def test_a_slight_warming_is_the_linear_term() -> None:
    linear = FrictionLaw((ThermalViscous(0.02, 30.0),)).torque(0.7, temperature=30.001)
    exponential = FrictionLaw((ThermalFriction(0.5, 0.8, 0.02, 0.0, 30.0),)).torque(0.7, temperature=30.001)
    assert exponential == pytest.approx(float(linear), rel=1e-4)


def test_kinematic_error_is_lagrange_s_equation_of_a_load_that_runs_ahead() -> None:
    rng = np.random.default_rng(5)
    q, v, a = rng.uniform(-2.0, 2.0, 200), rng.normal(size=200), 5.0 * rng.normal(size=200)
    n, inertia = 30.0, 0.3

    def wave(x: FloatArray) -> FloatArray:
        return np.asarray(2e-8 * np.sin(n * x) - 1e-8 * np.cos(n * x))

    rising = (wave(q + 1e-6) - wave(q - 1e-6)) / 2e-6
    bending = -(n**2) * wave(q)
    load = q + wave(q)
    along = 1.0 + rising
    expected = along * (inertia * (along * a + bending * v**2) + np.cos(load) - 2.0 * np.sin(load))
    expected -= inertia * a + np.cos(q) - 2.0 * np.sin(q)
    found = np.asarray(FrictionLaw((UNEVEN,)).torque(v, position=q, acceleration=a))
    assert np.max(np.abs(found)) > 1e-6
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.max(np.abs(found)))


def test_dwell_stiction_follows_its_differential_equation() -> None:
    velocity = stepwise_motion(1200)

    def rate(v: float, share: FloatArray) -> FloatArray:
        return (1.0 - share) / 0.3 if abs(v) < 3e-3 else -abs(v) / 5e-3 * share

    share = solve(rate, np.zeros(1), velocity)[:, 0]
    assert np.max(share) > 0.3
    np.testing.assert_allclose(advance(DWELL, velocity), 0.4 * share * np.sign(velocity), atol=1e-8)


def test_a_long_rest_brings_the_whole_rise_and_a_short_travel_takes_it_away() -> None:
    velocity = np.concatenate([np.zeros(3000), np.full(200, 0.1)])
    torque = advance(DWELL, velocity)
    assert torque[3000] == pytest.approx(0.4 * math.exp(-1e-4 / 5e-3), rel=1e-3)
    assert torque[-1] == pytest.approx(0.4 * math.exp(-0.02 / 5e-3), rel=1e-3)
    assert np.all(torque[:3000] == 0.0)


def test_lagging_friction_follows_its_differential_equation() -> None:
    velocity = stepwise_motion(1200)
    felt = solve(lambda v, u: (v - u) / 8e-3, np.zeros(1), velocity)[:, 0]
    curves = [REVERSE if v < 0.0 else FORWARD for v in velocity]
    dry = np.array([c.dry_level(np.abs(u)) for c, u in zip(curves, felt, strict=True)])
    expected = dry * np.sign(velocity) + np.array([c.viscous_coefficient for c in curves]) * felt
    np.testing.assert_allclose(advance(LAGGED, velocity), expected, atol=1e-7)


def test_a_lagging_bristle_follows_its_differential_equations() -> None:
    time = STEP * np.arange(1200)
    velocity = 0.1 * np.sin(2.0 * np.pi * time) + 0.05 * np.sin(5.0 * time)

    def rate(v: float, y: FloatArray) -> FloatArray:
        level = (FORWARD if v >= 0.0 else REVERSE).dry_level(np.abs(y[1]))
        return np.array([v - 500.0 * abs(v) * y[0] / level, (v - y[1]) / 8e-3])

    z, felt = solve(rate, np.zeros(2), velocity).T
    viscous = np.where(velocity >= 0.0, 0.02, 0.03)
    expected = 500.0 * z + np.diff(z, prepend=0.0) / STEP + viscous * felt
    found = advance(LAGGED_LUGRE, velocity)
    assert np.max(np.abs(found)) > 0.4
    np.testing.assert_allclose(found, expected, atol=0.01 * np.max(np.abs(found)))


def test_a_lag_far_below_a_step_is_none() -> None:
    velocity, prompt = stepwise_motion(400), LuGre(FORWARD, REVERSE, 500.0, 1.0)
    short = LAGGED_LUGRE.with_parameters({"lag": 1e-6})
    np.testing.assert_allclose(advance(short, velocity), advance(prompt, velocity), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("term", [DWELL, LAGGED, LAGGED_LUGRE], ids=lambda term: term.name)
def test_states_of_many_joints_are_those_of_each(term: DynamicTerm) -> None:
    rows = np.stack([stepwise_motion(200), -0.5 * stepwise_motion(200)])
    state, found = term.rest_state(), []
    for k in range(rows.shape[1]):
        torque, state = term.advance(state, OperatingPoint(rows[:, k]), STEP)
        found.append(np.asarray(torque))
    np.testing.assert_allclose(np.array(found).T, [advance(term, row) for row in rows], rtol=1e-12)


@pytest.mark.parametrize("term", [THERMAL, UNEVEN, DWELL, LAGGED, LAGGED_LUGRE], ids=lambda term: term.name)
def test_a_model_file_holds_the_term(term: Term) -> None:
    model = FrictionModel(FrictionLaw((term,)))
    assert decode_model(encode_model(model)).law == model.law
    assert set(model.units()) == set(model.law.parameters())


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: ThermalFriction(0.0, 0.8, 0.02, 0.004, 30.0), "forward_viscous must be finite and positive"),
        (lambda: ThermalFriction(0.5, 0.8, math.nan, 0.004, 30.0), "viscous_slope must be finite"),
        (lambda: ThermalViscous(0.1, math.inf), "reference_temperature must be finite"),
        (lambda: Cogging(math.nan, 0.1, 9.0), "sine must be finite"),
        (lambda: PositionCoulomb(0.1, math.inf, 9.0), "cosine must be finite"),
        (lambda: SpringTorque(1.0, math.nan), "centre must be finite"),
        (lambda: EndStop(1.0, math.inf, 1.0), "edge must be finite"),
        (lambda: DwellStiction(-0.1, 0.3, 5e-3, 3e-3), "rise must be finite and not negative"),
        (lambda: DwellStiction(0.1, 0.3, 0.0, 3e-3), "travel must be finite and positive"),
        (lambda: KinematicError(math.inf, 0.0, 9.0, 0.3), "sine must be finite"),
        (lambda: KinematicError(0.1, 0.0, 9.0, -0.3), "load_inertia must be finite and not negative"),
        (lambda: LaggedStribeck(FORWARD, REVERSE, lag=0.0), "lag must be finite and positive"),
        (lambda: LaggedLuGre(FORWARD, REVERSE, 0.0, lag=0.1), "sigma_0 must be finite and positive"),
    ],
)
def test_bad_values_are_refused(build: Callable[[], Term], words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        build()
