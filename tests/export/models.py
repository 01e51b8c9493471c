"""Models that the tests of this folder share."""

from __future__ import annotations

from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    DwellStiction,
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

FORWARD = StribeckCurve(0.15, 0.60, 0.05, 0.02)
REVERSE = StribeckCurve(0.20, 0.70, 0.05, 0.03)


def make_model(*terms: Term, velocity: tuple[float, float] = (-1.0, 1.0)) -> FrictionModel:
    law = FrictionLaw(terms or (BidirectionalStribeck(FORWARD, REVERSE),))
    return FrictionModel(law, validity=Validity(velocity=velocity, normal_load=(0.5, 2.0)))


EXTRA_TERMS: tuple[Term, ...] = (
    Cogging(0.05, -0.03, 9.0),
    PositionCoulomb(0.04, 0.02, 3.0),
    SpringTorque(0.3, 0.1, 0.2),
    EndStop(2.0, -0.5, -1.0, 0.4, 1.2, 0.7),
    LoadCoulomb(0.1),
    LoadQuadratic(0.02),
    LoadStribeck(0.1, 0.07),
    QuadraticDrag(0.05),
    PowerLawViscous(0.1, 0.6),
    ThermalViscous(0.002, 25.0),
    ThermalFriction(0.05, 0.08, 0.002, 0.001, 30.0),
    KinematicError(2e-3, -1e-3, 9.0, 0.3, 1.0, -0.5),
    DwellStiction(0.2, 0.3, 5e-3, 3e-3),
)


def make_extended(*terms: Term) -> FrictionModel:
    """The Stribeck model with terms over load, position, temperature, acceleration and rests: `terms`, or all."""
    law = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE), *(terms or EXTRA_TERMS)))
    ranges = Validity(
        velocity=(-1.0, 1.2),
        position=(-1.0, 1.0),
        load_torque=(-3.0, 2.0),
        normal_load=(0.5, 2.0),
        temperature=(10.0, 60.0),
    )
    return FrictionModel(law, validity=ranges)


def make_lugre() -> FrictionModel:
    return make_model(LuGre(FORWARD, FORWARD, sigma_0=6000.0, sigma_1=5.0))
