"""Terms over load, position and temperature in plain floats: what they are by their laws, within the limits."""

from __future__ import annotations

import math

import pytest

from fricomp.control import Compensator
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    EndStop,
    FrictionLaw,
    KinematicError,
    LoadCoulomb,
    LoadQuadratic,
    LoadStribeck,
    PositionCoulomb,
    PowerLawViscous,
    QuadraticDrag,
    SpringTorque,
    StribeckCurve,
    Term,
    ThermalFriction,
    ThermalViscous,
)
from fricomp.model import FrictionModel, Validity

CORE = BidirectionalStribeck(StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03))
INPUTS = ("position", "load_torque", "temperature", "acceleration")
TERMS: tuple[Term, ...] = (
    Cogging(0.05, -0.03, 9.0),
    PositionCoulomb(0.04, 0.02, 3.0),
    SpringTorque(0.3, 0.1),
    EndStop(2.0, 0.5, 1.0),
    EndStop(2.0, -0.5, -1.0),
    LoadCoulomb(0.1),
    LoadQuadratic(0.02),
    LoadStribeck(0.1, 0.07),
    QuadraticDrag(0.05),
    PowerLawViscous(0.1, 0.6),
    ThermalViscous(0.002, 25.0),
    ThermalFriction(0.05, 0.08, 0.002, 0.001, 30.0),
    KinematicError(2e-3, -1e-3, 9.0, 0.3, 1.0, -0.5),
)


def make_model(*terms: Term) -> FrictionModel:
    ranges = Validity(velocity=(-1.0, 1.0), position=(-1.0, 1.0), load_torque=(-3.0, 3.0), temperature=(10.0, 60.0))
    return FrictionModel(FrictionLaw((CORE, *terms)), validity=ranges)


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.name)
@pytest.mark.parametrize("velocity", [-0.8, -0.06, 0.06, 0.8])
@pytest.mark.parametrize("place", [(0.7, 2.0, 40.0, 3.0), (-0.8, -1.5, 12.0, -1.0)])
def test_compensation_is_the_law(term: Term, velocity: float, place: tuple[float, float, float, float]) -> None:
    model, inputs = make_model(term), dict(zip(INPUTS, place, strict=True))
    compensator = Compensator(model, source="reference", gain=1.0, smoothing=1e-4)
    expected = float(model.torque(velocity, **inputs))
    assert compensator.torque(velocity, **inputs) == pytest.approx(expected, rel=1e-12)


def test_what_holds_a_position_is_there_at_rest_and_dry_friction_is_not() -> None:
    model = make_model(Cogging(0.05, 0.0, 9.0), LoadCoulomb(0.1))
    compensator = Compensator(model, gain=1.0)
    assert compensator.torque(0.0, 0.0, position=0.1, load_torque=2.0) == pytest.approx(0.05 * math.sin(0.9))


def test_authority_holds_waves_and_loads() -> None:
    plain = Compensator(make_model()).settings.authority
    assert Compensator(make_model(Cogging(0.3, 0.4, 9.0))).settings.authority == pytest.approx(plain + 0.5)
    assert Compensator(make_model(LoadCoulomb(0.2))).settings.authority == pytest.approx(plain + 0.6)


def test_load_of_unknown_range_is_trusted_as_far_as_the_rest() -> None:
    model = FrictionModel(FrictionLaw((Coulomb(0.3), LoadCoulomb(0.2))), validity=Validity(velocity=(-1.0, 1.0)))
    compensator = Compensator(model, gain=1.0)
    assert compensator.torque(0.5, load_torque=50.0) == compensator.settings.authority == pytest.approx(0.6)
    assert "load torque" in compensator.describe()


def test_load_beyond_its_range_counts_as_its_end() -> None:
    compensator = Compensator(make_model(LoadCoulomb(0.1)), gain=1.0, authority=50.0)
    assert compensator.torque(0.5, load_torque=40.0) == compensator.torque(0.5, load_torque=3.0)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", INPUTS)
def test_input_that_is_not_finite_gives_zero_and_is_counted(bad: float, name: str) -> None:
    compensator = Compensator(make_model(*TERMS[:1], LoadCoulomb(0.1), ThermalViscous(0.002, 25.0)))
    assert compensator.torque(0.3, **{name: bad}) == 0.0
    assert compensator.rejected == 1


def test_inputs_are_those_of_the_terms() -> None:
    assert Compensator(make_model()).inputs == frozenset()
    model = make_model(Cogging(0.1, 0.0, 3.0), LoadCoulomb(0.1), ThermalViscous(0.002, 25.0))
    assert Compensator(model).inputs == {"position", "load_torque", "temperature"}
    assert Compensator(make_model(*TERMS[-2:])).inputs == {"position", "temperature", "acceleration"}
