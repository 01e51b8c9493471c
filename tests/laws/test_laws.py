"""Friction laws against their equations, and their limits."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    FrictionLaw,
    LoadScaling,
    LuGre,
    OperatingPoint,
    SmoothedCoulomb,
    SpringTorque,
    Stribeck,
    StribeckCurve,
    Viscous,
    term_class,
    term_names,
)

FORWARD = StribeckCurve(0.15, 0.60, 0.05, 0.02)
REVERSE = StribeckCurve(0.20, 0.70, 0.05, 0.03)
STRIBECK = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE),))


def test_a_curve_is_equation_2_of_the_paper() -> None:
    speed = np.array([0.0, 0.05, 0.5, 4.0])
    falling = np.array([1.0, np.exp(-1.0), np.exp(-100.0), 0.0])
    np.testing.assert_allclose(FORWARD.level(speed), 0.15 + 0.45 * falling + 0.02 * speed)
    cubic = StribeckCurve(0.15, 0.60, 0.05, 0.02, stribeck_exponent=3.0)
    np.testing.assert_allclose(cubic.level(np.array([0.1])), 0.15 + 0.45 * np.exp(-8.0) + 0.002)


def test_bidirectional_stribeck_is_equation_3_of_the_paper() -> None:
    v = np.array([-1.0, -0.05, 0.03, 0.5])
    expected = [
        -(0.20 + 0.50 * np.exp(-400.0)) - 0.03,
        -(0.20 + 0.50 * np.exp(-1.0)) - 0.0015,
        0.15 + 0.45 * np.exp(-0.36) + 0.0006,
        0.15 + 0.45 * np.exp(-100.0) + 0.01,
    ]
    np.testing.assert_allclose(STRIBECK.torque(v), expected, rtol=1e-14)


def test_a_float_gives_a_float_and_an_array_an_array() -> None:
    assert type(STRIBECK.torque(0.1)) is float
    assert STRIBECK.torque(np.zeros((2, 3))).shape == (2, 3)  # type: ignore[union-attr]


@pytest.mark.parametrize("velocity", [0.0, np.zeros(3)])
def test_friction_at_rest_is_zero(velocity: float) -> None:
    law = FrictionLaw((Coulomb(1.0), Viscous(0.1), Stribeck(FORWARD), SmoothedCoulomb(1.0, 0.1)))
    assert np.all(np.asarray(law.torque(velocity)) == 0.0)


def test_symmetric_stribeck_is_odd() -> None:
    law = FrictionLaw((Stribeck(FORWARD),))
    v = np.linspace(0.001, 1.0, 50)
    np.testing.assert_array_equal(law.torque(v), -np.asarray(law.torque(-v)))


def test_a_spring_stiffens_with_the_cube_of_its_stretch() -> None:
    law = FrictionLaw((SpringTorque(2.0, 0.5, 0.3),))
    position = np.array([-1.0, 0.5, 1.5])
    point = OperatingPoint(velocity=np.zeros(3), position=position)
    np.testing.assert_allclose(law.terms[0].torque(point), [-3.0 - 0.6 * 1.5**3, 0.0, 2.6])
    with pytest.raises(ParameterError, match="hardening"):
        SpringTorque(2.0, 0.5, -0.1)


@pytest.mark.parametrize("shape", ["tanh", "arctan"])
def test_smoothed_forms_approach_coulomb_friction(shape: str) -> None:
    smooth = FrictionLaw((SmoothedCoulomb(2.0, 1e-6, shape),))  # type: ignore[arg-type]
    v = np.array([-1.0, 1.0])
    np.testing.assert_allclose(smooth.torque(v), FrictionLaw((Coulomb(2.0),)).torque(v), rtol=1e-5)


def test_normal_load_scales_dry_friction_only() -> None:
    law = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE, LoadScaling(1.0, 10.0)),))
    dry = STRIBECK.torque(0.5) - 0.02 * 0.5
    assert law.torque(0.5, normal_load=30.0) == pytest.approx(3.0 * dry + 0.01, rel=1e-14)
    assert law.torque(0.5) == STRIBECK.torque(0.5)
    symmetric = FrictionLaw((Stribeck(FORWARD, LoadScaling(1.0, 10.0)),))
    assert symmetric.torque(-0.5, normal_load=30.0) == pytest.approx(-3.0 * dry - 0.01, rel=1e-14)


def steady_torque(law: FrictionLaw, velocity: float, dt: float, steps: int) -> float:
    state, torque = law.rest_state(), 0.0
    for _ in range(steps):
        torque, state = law.advance(state, OperatingPoint(velocity), dt)  # type: ignore[assignment]
    return torque


@pytest.mark.parametrize("velocity", [-0.2, -0.01, 0.002, 0.05, 0.7])
def test_lugre_slides_on_the_static_stribeck_curve(velocity: float) -> None:
    lugre = FrictionLaw((LuGre(FORWARD, REVERSE, sigma_0=500.0, sigma_1=1.0),))
    assert steady_torque(lugre, velocity, 1e-3, 20_000) == pytest.approx(STRIBECK.torque(velocity), rel=1e-6)


def test_static_stribeck_is_ninety_per_cent_right_about_lugre_in_slow_reversing_motion() -> None:
    """The figure that [luo2024pinn] quotes from [hensen2003]; what is missing sits in the reversals.

    Measured here: 96 % by mean absolute error and 97 % of the samples within a tenth, but 75 % by RMS, because
    the static law jumps at a reversal where a bristle is still being bent over.
    """
    lugre = FrictionLaw((LuGre(FORWARD, REVERSE, sigma_0=5e3, sigma_1=5.0),))
    dt, t = 1e-3, np.arange(0.0, 20.0, 1e-3)
    v = 0.04 * np.sin(2.0 * np.pi * 0.1 * t)
    state, torque = lugre.rest_state(), np.empty_like(t)
    for i, velocity in enumerate(v):
        torque[i], state = lugre.advance(state, OperatingPoint(velocity), dt)
    static = np.asarray(STRIBECK.torque(v))
    error = np.abs(torque - static)
    assert 1.0 - error.mean() / np.abs(torque).mean() == pytest.approx(0.961, abs=0.005)
    assert np.mean(error < 0.1 * np.abs(static)) == pytest.approx(0.966, abs=0.005)
    bending = np.abs(torque - np.sign(v) * np.abs(static)) > 0.1 * np.abs(static)
    since_reversal = (np.abs(t % 5.0)) < 0.25
    assert since_reversal[bending].mean() > 0.95


@pytest.mark.parametrize("dt", [1e-5, 1e-2, 10.0])
def test_bristle_update_is_stable_and_exact_at_any_step(dt: float) -> None:
    dahl = FrictionLaw((Dahl(1.0, sigma_0=1e4),))
    whole, _ = dahl.advance(dahl.rest_state(), OperatingPoint(0.3), dt)
    state, torque = dahl.rest_state(), 0.0
    for _ in range(10):
        torque, state = dahl.advance(state, OperatingPoint(0.3), dt / 10)  # type: ignore[assignment]
    assert torque == pytest.approx(whole, rel=1e-12)
    assert torque == pytest.approx(1.0 - np.exp(-1e4 * 0.3 * dt), rel=1e-9)


def test_dahl_follows_its_differential_equation_through_a_reversal() -> None:
    fine, z = 1e-6, 0.0
    v = np.concatenate([np.full(2000, 0.01), np.full(3000, -0.02)])
    for velocity in v:
        z += fine * (velocity - 2e3 * abs(velocity) * z / 0.5)
    dahl = FrictionLaw((Dahl(0.5, sigma_0=2e3),))
    state = dahl.rest_state()
    for velocity, steps in ((0.01, 2), (-0.02, 3)):
        for _ in range(steps):
            torque, state = dahl.advance(state, OperatingPoint(velocity), 1e-3)
    assert torque == pytest.approx(2e3 * z, rel=1e-4)


def test_parameters_can_be_read_and_replaced_by_name() -> None:
    law = STRIBECK.replace({"stribeck.reverse.static_torque": 0.9})
    assert law.parameters()["stribeck.reverse.static_torque"] == 0.9
    assert law.units("N", "m")["stribeck.forward.viscous_coefficient"] == "N·s/m"


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: FrictionLaw(()), "at least one term"),
        (lambda: FrictionLaw((Coulomb(1.0), Coulomb(2.0))), "each term may occur once"),
        (lambda: Coulomb(-1.0), "as a magnitude"),
        (lambda: Viscous(float("nan")), "finite"),
        (lambda: StribeckCurve(1.0, 2.0, 0.0, 0.1), "stribeck_velocity must be finite and positive"),
        (lambda: SmoothedCoulomb(1.0, 0.1, "erf"), "'tanh' or 'arctan'"),  # type: ignore[arg-type]
        (lambda: STRIBECK.replace({"stribeck.fc": 1.0}), "unknown parameter"),
        (lambda: STRIBECK.term("dahl"), "no term 'dahl'"),
        (lambda: term_class("grease"), "unknown friction term"),
        (lambda: FrictionLaw((Dahl(1.0, 1e3),)).advance((0.0,), OperatingPoint(0.1), 0.0), "dt must be positive"),
    ],
)
def test_bad_values_are_refused_with_a_sentence(build: object, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        build()  # type: ignore[operator]


def test_every_term_of_the_catalogue_is_registered() -> None:
    basic = {"coulomb", "viscous", "smoothed_coulomb", "stribeck", "symmetric_stribeck", "dahl", "lugre"}
    assert basic <= set(term_names())
