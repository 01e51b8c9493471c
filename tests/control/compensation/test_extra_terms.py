"""Terms over load, position, temperature, acceleration in plain floats: what they are by their laws, within limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
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
    LuGre,
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
    EndStop(2.0, -0.5, -1.0, 0.4, 1.2, 0.7),
    LoadCoulomb(0.1),
    LoadQuadratic(0.02),
    LoadStribeck(0.1, 0.07),
    QuadraticDrag(0.05),
    PowerLawViscous(0.1, 0.6),
    ThermalViscous(0.001, 25.0),
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


WARM = (ThermalFriction(0.02, 0.03, 0.002, 0.005, 30.0), ThermalViscous(0.002, 30.0))
TEMPERATURES = [-1e308, -1e6, -40.0, 0.0, 25.0, 80.0, 1e6, 1e308]


@pytest.mark.parametrize("term", WARM, ids=lambda term: term.name)
@pytest.mark.parametrize("velocity", [-0.5, 0.5])
def test_no_temperature_gives_more_than_the_ends_of_its_range(term: Term, velocity: float) -> None:
    model = make_model(term)
    model = replace(model, validity=replace(model.validity, temperature=(20.0, 40.0)))
    compensator = Compensator(model, gain=1.0, source="reference", authority=50.0)
    hot, cold = (compensator.torque(velocity, temperature=edge) for edge in (40.0, 20.0))
    expected = [float(model.torque(velocity, temperature=edge)) for edge in (40.0, 20.0)]
    assert [hot, cold] == pytest.approx(expected, rel=1e-12)
    assert 0.0 < hot / velocity < cold / velocity
    for temperature in TEMPERATURES:
        assert hot / velocity <= compensator.torque(velocity, temperature=temperature) / velocity <= cold / velocity
    assert compensator.rejected == 0


@pytest.mark.parametrize("core", [CORE, LuGre(CORE.forward, CORE.reverse, 6000.0, 1.0)], ids=lambda term: term.name)
@pytest.mark.parametrize("velocity", [-0.5, 0.5])
def test_dry_friction_never_drives_at_any_temperature(core: Term, velocity: float) -> None:
    model = FrictionModel(FrictionLaw((core, WARM[0])), validity=Validity(velocity=(-1.0, 1.0)))
    compensator = Compensator(model, gain=1.0, source="reference", temperature_range=(-math.inf, math.inf))
    for _ in range(10):  # past presliding
        compensator.torque(velocity)
    for temperature in TEMPERATURES:
        assert compensator.torque(velocity, temperature=temperature) / velocity > 0.0
    viscous, reference = (0.02, 0.02) if velocity > 0.0 else (0.03, 0.03)
    left = viscous + reference * math.expm1(-min(0.002 * 50.0 / reference, 3.0))
    assert compensator.torque(velocity, temperature=80.0) == pytest.approx(left * velocity, rel=1e-9)


@pytest.mark.parametrize(
    ("viscous_slope", "coulomb_slope", "reach"),
    [(0.001, 0.01, 0.02 * math.log(2.0) / 0.001), (-0.001, 0.02, 0.15 / 0.02), (0.0, -0.01, 0.15 / 0.01)],
)
def test_without_a_range_a_temperature_is_followed_until_a_part_of_friction_doubles(
    viscous_slope: float, coulomb_slope: float, reach: float
) -> None:
    term = ThermalFriction(0.02, 0.03, viscous_slope, coulomb_slope, 25.0)
    model = FrictionModel(FrictionLaw((CORE, term)), validity=Validity(velocity=(-1.0, 1.0)))
    compensator = Compensator(model, gain=1.0, source="reference")
    assert compensator.settings.temperature_range == pytest.approx((25.0 - reach, 25.0 + reach))
    assert "range of temperature" in compensator.describe()
    ends = sorted(compensator.torque(0.5, temperature=25.0 + side * reach) for side in (-1.0, 1.0))
    for temperature in (-273.0, 1e3):
        assert ends[0] - 1e-12 <= compensator.torque(0.5, temperature=temperature) <= ends[1] + 1e-12


@pytest.mark.parametrize("stated", [None, (-40.0, 120.0)])
@pytest.mark.parametrize("slope", [0.002, -0.002])
@pytest.mark.parametrize("velocity", [-0.5, 0.5])
def test_viscous_friction_never_drives_at_any_temperature(
    stated: tuple[float, float] | None, slope: float, velocity: float
) -> None:
    model = FrictionModel(
        FrictionLaw((CORE, ThermalViscous(slope, 30.0))), validity=Validity(velocity=(-1.0, 1.0), temperature=stated)
    )
    compensator = Compensator(model, gain=1.0, source="reference")
    viscous = 0.02 if velocity > 0.0 else 0.03
    dry = float(FrictionLaw((CORE,)).torque(velocity)) - viscous * velocity
    for temperature in TEMPERATURES:
        torque = compensator.torque(velocity, temperature=temperature)
        assert torque / dry > 1.0 - 1e-9
        assert abs(torque) < compensator.settings.authority + 1e-12
    within, left = 33.0, viscous - 3.0 * slope
    assert compensator.torque(velocity, temperature=within) == pytest.approx(dry + left * velocity, rel=1e-9)
    assert ("range of temperature" in compensator.describe()) == (stated is None)


UNEVEN = KinematicError(2e-3, -1e-3, 9.0, 0.3, 1.0, -0.5)


@pytest.mark.parametrize("stated", [None, (-2.0, 3.0)])
def test_an_absurd_acceleration_counts_as_the_end_of_its_range(stated: tuple[float, float] | None) -> None:
    model, plain = make_model(UNEVEN), Compensator(make_model())
    model = replace(model, validity=replace(model.validity, acceleration=stated))
    compensator = Compensator(model, gain=1.0, source="reference")
    settings = compensator.settings
    low, high = settings.acceleration_range or (0.0, 0.0)
    assert (low, high) == (stated or (-high, high))
    assert ("range of acceleration" in compensator.describe()) == (stated is None)
    share = settings.authority - plain.settings.authority
    for position in np.linspace(-1.0, 1.0, 50).tolist():
        for absurd, edge in ((1e3, high), (1e300, high), (1e308, high), (-1e3, low), (-1e308, low)):
            expected = float(model.torque(0.5, position=position, acceleration=edge))
            torque = compensator.torque(0.5, position=position, acceleration=absurd)
            assert torque == pytest.approx(expected, rel=1e-9)
            assert abs(torque - plain.torque(0.5) / plain.settings.gain) <= share
    assert compensator.rejected == 0


def test_the_acceleration_that_is_followed_asks_for_as_much_as_the_rest_of_its_term() -> None:
    plain, share = Compensator(make_model()).settings.authority, math.hypot(2e-3, 1e-3)
    held = share * (10.0 * math.hypot(1.0, 0.5) + 0.3 * 9.0**2)
    settings = Compensator(make_model(UNEVEN)).settings
    assert settings.acceleration_range is not None
    assert share * 2.0 * 0.3 * 9.0 * settings.acceleration_range[1] == pytest.approx(held)
    assert settings.authority == pytest.approx(plain + 2.0 * held)
    assert Compensator(make_model(replace(UNEVEN, load_inertia=0.0))).settings.acceleration_range is None


def test_a_torque_that_is_not_finite_is_no_torque_and_is_counted() -> None:
    compensator = Compensator(make_model(SpringTorque(0.3, 0.1, 1.0)))
    assert compensator.torque(0.3, position=1e200) == 0.0
    assert compensator.rejected == 1


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
