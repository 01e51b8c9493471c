"""Online adaptation: follows slowly while sliding, frozen at reversals, bounded always."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fricomp.control import AdaptationSettings, Compensator, OnlineAdaptation
from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    DwellStiction,
    FrictionLaw,
    LoadScaling,
    StribeckCurve,
    ThermalFriction,
    Viscous,
)
from fricomp.model import Covariance, FrictionModel, Provenance, Validity

CURVE = StribeckCurve(0.2, 0.3, 0.05, 0.4)
MODEL = FrictionModel(FrictionLaw((BidirectionalStribeck(CURVE, CURVE),)), validity=Validity(velocity=(-2.0, 2.0)))
BOUNDS = AdaptationSettings(time_constant=2.0, dry_bounds=(0.7, 1.3), viscous_bounds=(0.5, 1.5))


def follow(adaptation: OnlineAdaptation, scales: tuple[float, float], seconds: float) -> None:
    """A sine with friction of other scales."""
    for k in range(round(seconds * 1000)):
        velocity = 1.5 * math.sin(2.0 * math.pi * 0.25 * k * 1e-3)
        dry = 0.2 + 0.1 * math.exp(-((velocity / 0.05) ** 2))
        torque = math.copysign(scales[0] * dry, velocity) + scales[1] * 0.4 * velocity
        adaptation.update(velocity, torque)


def test_follows_dry_and_viscous_levels() -> None:
    compensator = Compensator(MODEL, gain=1.0, authority=5.0)
    adaptation = OnlineAdaptation(compensator, BOUNDS)
    follow(adaptation, (1.15, 0.7), 120.0)
    assert adaptation.dry_scale == pytest.approx(1.15, abs=0.03)
    assert adaptation.viscous_scale == pytest.approx(0.7, abs=0.03)
    assert compensator.torque(1.0) == pytest.approx(1.15 * 0.2 + 0.7 * 0.4, rel=0.02)
    adaptation.reset()
    assert compensator.torque(1.0) == pytest.approx(0.6)


def test_friction_that_follows_the_normal_load_is_no_change_of_the_joint() -> None:
    law = BidirectionalStribeck(CURVE, CURVE, load=LoadScaling(load_sensitivity=1.0, reference_load=10.0))
    notes = Provenance(notes={"normal_load": "transmitted load"})
    model = FrictionModel(
        FrictionLaw((law,)), validity=Validity(velocity=(-2.0, 2.0), normal_load=(5.0, 40.0)), provenance=notes
    )
    compensator = Compensator(model, gain=1.0, authority=50.0)
    adaptation = OnlineAdaptation(compensator, BOUNDS)
    for k in range(60_000):
        velocity, load = 1.5 * math.sin(0.5 * math.pi * k * 1e-3), 20.0 + 10.0 * math.sin(0.3 * k * 1e-3)
        torque = float(model.law.torque(velocity, normal_load=load))
        adaptation.update(velocity, torque, load_torque=load, normal_load=load)
    assert adaptation.dry_scale == pytest.approx(1.0, abs=1e-3)
    assert adaptation.viscous_scale == pytest.approx(1.0, abs=1e-3)


def test_never_leaves_its_bounds() -> None:
    adaptation = OnlineAdaptation(Compensator(MODEL), BOUNDS)
    follow(adaptation, (50.0, 50.0), 20.0)
    assert (adaptation.dry_scale, adaptation.viscous_scale) == (1.3, 1.5)
    adaptation.reset()
    follow(adaptation, (-50.0, -50.0), 20.0)
    assert (adaptation.dry_scale, adaptation.viscous_scale) == (0.7, 0.5)


def test_viscous_friction_alone_is_followed() -> None:
    model = FrictionModel(FrictionLaw((Viscous(0.4),)), validity=Validity(velocity=(-2.0, 2.0)))
    adaptation = OnlineAdaptation(Compensator(model, gain=1.0), replace(BOUNDS, sliding_velocity=0.1))
    for _ in range(20_000):
        adaptation.update(1.0, 0.7 * 0.4)
    assert adaptation.viscous_scale == pytest.approx(0.7, abs=0.01)
    assert adaptation.dry_scale == pytest.approx(1.0)


@pytest.mark.parametrize("sample", [(1e200, 1.0), (-1e200, 1.0), (1e150, 1e300)])
def test_samples_that_no_number_holds_change_nothing_and_raise_nothing(sample: tuple[float, float]) -> None:
    compensator = Compensator(MODEL, gain=1.0, authority=5.0)
    adaptation = OnlineAdaptation(compensator, BOUNDS)
    for k in range(2000):
        adaptation.update(sample[0], sample[1] * (-1.0) ** k)
        assert 0.7 <= adaptation.dry_scale <= 1.3
        assert 0.5 <= adaptation.viscous_scale <= 1.5
    assert math.isfinite(compensator.torque(1.0))


def test_is_frozen_at_rest_and_after_reversals() -> None:
    adaptation = OnlineAdaptation(Compensator(MODEL), BOUNDS)
    for velocity in (0.0, 0.1, -0.1):
        for _ in range(2000):
            adaptation.update(velocity, 99.0)
    for k in range(4000):  # fast, but each direction shorter than the settling time
        adaptation.update(1.0 if (k // 150) % 2 else -1.0, 99.0)
    assert adaptation.frozen
    assert (adaptation.dry_scale, adaptation.viscous_scale) == (1.0, 1.0)


def test_speeds_at_which_rests_bring_friction_are_not_sliding() -> None:
    law = FrictionLaw((*MODEL.law.terms, DwellStiction(0.2, 0.1, 5e-3, 0.4)))
    adaptation = OnlineAdaptation(Compensator(FrictionModel(law, validity=MODEL.validity)), BOUNDS)
    for _ in range(3000):
        adaptation.update(0.3, 9.0)
    assert adaptation.frozen
    for _ in range(3000):
        adaptation.update(0.5, 0.2 + 0.4 * 0.5)
    assert (adaptation.dry_scale, adaptation.viscous_scale) == pytest.approx((1.0, 1.0))


def test_a_wrong_temperature_is_that_at_the_end_of_its_range() -> None:
    law = FrictionLaw((*MODEL.law.terms, ThermalFriction(0.4, 0.4, 0.0, 5e-3, 30.0)))
    model = FrictionModel(law, validity=Validity(velocity=(-2.0, 2.0), temperature=(20.0, 40.0)))
    adaptation = OnlineAdaptation(Compensator(model), BOUNDS)
    for _ in range(3000):
        adaptation.update(0.5, 0.2 - 0.05 + 0.4 * 0.5, temperature=150.0)
    assert (adaptation.dry_scale, adaptation.viscous_scale) == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize("bad", [(math.nan, 1.0), (1.0, math.inf), (math.inf, math.nan)])
def test_what_is_not_finite_changes_nothing(bad: tuple[float, float]) -> None:
    adaptation = OnlineAdaptation(Compensator(MODEL), BOUNDS)
    for _ in range(1000):
        adaptation.update(*bad)
    assert (adaptation.dry_scale, adaptation.viscous_scale) == (1.0, 1.0)


def test_bounds_are_the_identified_intervals() -> None:
    names = ("stribeck.forward.coulomb_torque", "stribeck.forward.viscous_coefficient")
    model = FrictionModel(MODEL.law, validity=MODEL.validity, covariance=Covariance(names, np.diag([1e-4, 1e-4])))
    adaptation = OnlineAdaptation(Compensator(model), AdaptationSettings(time_constant=0.5))
    follow(adaptation, (50.0, 50.0), 20.0)
    assert adaptation.dry_scale == pytest.approx(1.0 + 1.96 * 0.01 / 0.2)
    assert adaptation.viscous_scale == pytest.approx(1.0 + 1.96 * 0.01 / 0.4)


def test_needs_bounds_from_somewhere() -> None:
    with pytest.raises(ParameterError, match="no covariance"):
        OnlineAdaptation(Compensator(MODEL))
    with pytest.raises(ParameterError, match="hold 1"):
        AdaptationSettings(dry_bounds=(1.1, 1.2))
