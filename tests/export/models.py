"""Models that the tests of this folder share."""

from __future__ import annotations

from fricomp.laws import BidirectionalStribeck, FrictionLaw, LuGre, StribeckCurve, Term
from fricomp.model import FrictionModel, Validity

FORWARD = StribeckCurve(0.15, 0.60, 0.05, 0.02)
REVERSE = StribeckCurve(0.20, 0.70, 0.05, 0.03)


def make_model(*terms: Term, velocity: tuple[float, float] = (-1.0, 1.0)) -> FrictionModel:
    law = FrictionLaw(terms or (BidirectionalStribeck(FORWARD, REVERSE),))
    return FrictionModel(law, validity=Validity(velocity=velocity, normal_load=(0.5, 2.0)))


def make_lugre() -> FrictionModel:
    return make_model(LuGre(FORWARD, FORWARD, sigma_0=6000.0, sigma_1=5.0))
