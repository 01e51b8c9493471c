"""Settings chosen from the model and its loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.control import LoopDynamics, check_loop
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.confidence import compute_confident_gain, compute_friction_deviation
from fricomp.control.compensation.limit_cycle import LIMIT_CYCLE_MARGIN
from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    FrictionLaw,
    LuGre,
    SpringTorque,
    StribeckCurve,
    Term,
    Viscous,
)
from fricomp.model import Covariance, FrictionModel, Validity


def make_model(static: float, covariance: Covariance | None = None) -> FrictionModel:
    curve = StribeckCurve(0.2, static, 0.05, 0.02)
    law = FrictionLaw((BidirectionalStribeck(curve, curve),))
    return FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)), covariance=covariance)


def pd_loop(bandwidth: float, delay: float = 0.002) -> LoopDynamics:
    omega = 2.0 * np.pi * bandwidth
    return LoopDynamics(0.05, 0.05 * omega**2, 0.1 * omega, delay)


def test_smoothing_is_a_hundredth_of_top_speed_and_at_most_a_tenth_of_stribeck() -> None:
    assert choose_settings(make_model(0.3)).smoothing == pytest.approx(0.005)
    flat = FrictionModel(FrictionLaw((Coulomb(0.3), Viscous(0.1))), validity=Validity(velocity=(-2.0, 2.0)))
    assert choose_settings(flat).smoothing == pytest.approx(0.02)


def test_authority_is_the_largest_friction_of_the_range() -> None:
    assert choose_settings(make_model(0.8)).authority == pytest.approx(0.8)
    viscous = FrictionModel(FrictionLaw((Viscous(0.5),)), validity=Validity(velocity=(-2.0, 2.0)))
    assert choose_settings(viscous).authority == pytest.approx(1.0)


def test_reference_is_followed_by_default_where_friction_hardly_falls() -> None:
    assert choose_settings(make_model(0.3)).source == "reference"


def test_falling_branch_is_recognised_from_the_model_alone_and_said() -> None:
    settings = choose_settings(make_model(0.8))
    assert settings.source == "blend"
    assert "4.0 times Coulomb" in " ".join(settings.notes)


def test_a_level_that_a_bristle_holds_counts_as_coulomb_friction() -> None:
    """Of an arm's joint whose level lies in three terms static friction was told to be 4.4 times Coulomb friction."""
    rest, bent = StribeckCurve(0.1, 0.4, 0.2, 0.3), StribeckCurve(0.8, 0.8, 1.0, 0.0)
    law = FrictionLaw((BidirectionalStribeck(rest, rest), LuGre(bent, bent, 400.0, 0.0)))
    settings = choose_settings(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0))))
    assert settings.source == "reference"


def test_damping_of_the_loop_decides_where_it_is_known() -> None:
    model = make_model(0.8)  # falls by 10.3
    assert choose_settings(model, loop=pd_loop(5.0)).source == "blend"
    assert choose_settings(model, loop=pd_loop(20.0)).source == "reference"


@pytest.mark.parametrize("static", [0.3, 0.8])
@pytest.mark.parametrize(("bandwidth", "delay"), [(5.0, 0.003), (10.0, 0.001), (10.0, 0.003)])
def test_default_keeps_its_margin_to_the_limit_cycle(static: float, bandwidth: float, delay: float) -> None:
    check = check_loop(make_model(static), pd_loop(bandwidth, delay))
    assert check.margin >= LIMIT_CYCLE_MARGIN - 1.0
    assert check.drift < 1e-9
    assert check.is_safe


def test_a_lowered_gain_at_which_the_loop_still_oscillates_is_told() -> None:
    model, loop = make_model(0.8), pd_loop(5.0, 0.004)
    settings = choose_settings(model, loop=loop)
    assert not check_loop(model, loop, settings).is_safe
    assert "at which the loop may still oscillate" in settings.notes[-1]


def test_gain_is_the_lower_bound_of_friction_over_the_range() -> None:
    names = ("stribeck.forward.coulomb_torque", "stribeck.reverse.coulomb_torque")
    model = make_model(0.3, Covariance(names, np.diag([1e-4, 1e-4])))
    velocity = np.array([0.5])
    deviation = compute_friction_deviation(model, velocity)
    assert deviation == pytest.approx([0.01], rel=1e-6)
    gain = compute_confident_gain(model, (-1.0, 1.0))
    assert gain is not None
    friction = np.asarray(model.torque(np.geomspace(0.001, 1.0, 400)))
    assert gain == pytest.approx(1.0 - 1.645 * 0.01 / friction.min(), abs=0.01)
    assert choose_settings(model).gain == pytest.approx(gain)


@pytest.mark.parametrize("held", [SpringTorque(3.0, -1.0), SpringTorque(3.0, 0.05), Cogging(4.0, 0.5, 9.0)])
def test_what_holds_a_position_makes_no_friction_certain_or_uncertain(held: Term) -> None:
    names = ("stribeck.forward.coulomb_torque",)
    plain = make_model(0.3, Covariance(names, np.array([[0.05**2]])))
    parameter = next(name for name in FrictionLaw((held,)).parameters())
    more = Covariance((*names, parameter), np.diag([0.05**2, 1.0]))
    model = replace(plain, law=plain.law.with_term(held), covariance=more)
    assert 0.5 < choose_settings(plain).gain < 0.9
    assert choose_settings(model).gain == pytest.approx(choose_settings(plain).gain)


def test_uncertain_model_gets_a_low_gain_and_a_certain_one_stays_below_one() -> None:
    names = ("stribeck.forward.coulomb_torque",)
    assert choose_settings(make_model(0.3, Covariance(names, np.array([[4.0]])))).gain == 0.5
    assert choose_settings(make_model(0.3, Covariance(names, np.array([[1e-12]])))).gain < 1.0


def test_range_that_nobody_stated_is_assumed_and_said() -> None:
    settings = choose_settings(FrictionModel(make_model(0.3).law))
    assert settings.velocity_range == (-1.0, 1.0)
    assert "states no range" in settings.notes[0]


def test_deviation_needs_a_covariance() -> None:
    with pytest.raises(ParameterError, match="no covariance"):
        compute_friction_deviation(make_model(0.3), np.array([0.1]))


@pytest.mark.parametrize("field", ["inertia", "stiffness", "damping", "delay"])
def test_loop_must_be_physical(field: str) -> None:
    values = {"inertia": 0.1, "stiffness": 10.0, "damping": 1.0, "delay": 0.001}
    with pytest.raises(ParameterError):
        LoopDynamics(**(values | {field: -1.0}))
