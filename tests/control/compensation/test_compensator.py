"""The compensator: the model's friction, smoothed, bounded, and never anything that is not finite."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricomp.control import ArmCompensator, Compensator
from fricomp.control.compensation.batch import compute_compensation
from fricomp.control.compensation.curve import split_law
from fricomp.errors import ModelFileError, ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    Dahl,
    FrictionLaw,
    KinematicError,
    LoadCoulomb,
    LoadScaling,
    LuGre,
    OperatingPoint,
    SmoothedCoulomb,
    SpringTorque,
    StribeckCurve,
    Term,
    Viscous,
)
from fricomp.model import FrictionModel, Validity, save_model

FORWARD, REVERSE = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
numbers = st.one_of(st.floats(), st.integers(), st.just(10**400), st.just(1e308))
given_or_not = st.one_of(numbers, st.none())


def make_model(*terms: Term) -> FrictionModel:
    law = FrictionLaw(terms or (BidirectionalStribeck(FORWARD, REVERSE),))
    return FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0), normal_load=(0.5, 2.0)))


@pytest.mark.parametrize("velocity", [-0.9, -0.2, -0.04, 0.04, 0.3, 1.0])
def test_away_from_rest_it_is_the_model_times_the_gain(velocity: float) -> None:
    model = make_model()
    compensator = Compensator(model, source="reference", gain=0.9)
    assert compensator.torque(velocity) == pytest.approx(0.9 * float(model.torque(velocity)), rel=1e-6)


def test_at_rest_it_is_zero() -> None:
    assert Compensator(make_model()).torque(0.0) == 0.0
    assert Compensator(make_model()).torque(0.0, 0.0, 0.0, 1.0) == 0.0


def test_load_scales_the_dry_part_within_the_identified_range() -> None:
    model = make_model()
    compensator = Compensator(model, source="reference", gain=1.0, authority=5.0)
    assert compensator.torque(0.3, normal_load=1.5) == pytest.approx(float(model.torque(0.3, normal_load=1.5)))
    assert compensator.torque(0.3, normal_load=50.0) == pytest.approx(float(model.torque(0.3, normal_load=2.0)))


@pytest.mark.parametrize("load", [0.0, 1.0, 50.0])
def test_a_normal_load_that_nobody_measured_changes_nothing(load: float) -> None:
    model = replace(make_model(), validity=Validity(velocity=(-1.0, 1.0)))
    compensator = Compensator(model, source="reference", gain=1.0)
    assert compensator.torque(0.3, normal_load=load) == compensator.torque(0.3) > 0.1


def test_a_scaling_that_the_law_states_itself_holds_without_measured_loads() -> None:
    law = FrictionLaw((BidirectionalStribeck(FORWARD, REVERSE, LoadScaling(0.5, 2.0)),))
    model = FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0)))
    compensator = Compensator(model, source="reference", gain=1.0, authority=5.0)
    assert compensator.torque(0.3, normal_load=1.0) == pytest.approx(float(model.torque(0.3, normal_load=1.0)))


def test_compensation_fades_outside_the_identified_velocities() -> None:
    compensator = Compensator(make_model(), gain=1.0)
    inside, outside = compensator.torque(1.0), compensator.torque(1.25)
    assert 0.0 < outside < inside
    assert compensator.torque(1.5) == compensator.torque(80.0) == 0.0


@given(st.lists(st.tuples(numbers, given_or_not, given_or_not, given_or_not), min_size=1, max_size=20))
def test_any_number_gives_a_finite_torque_within_authority_and_rate(calls: list[tuple[Any, Any, Any, Any]]) -> None:
    compensator = Compensator(make_model(), torque_rate=100.0, authority=0.5, error_rate=1.0, rest_velocity=0.01)
    before = 0.0
    for call in calls:
        rejected = compensator.rejected
        torque = compensator.torque(*call)
        assert math.isfinite(torque)
        assert abs(torque) <= 0.5
        if compensator.rejected == rejected:
            assert abs(torque - before) <= 0.1 + 1e-12
        else:
            assert torque == 0.0
        before = torque


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", range(4))
def test_what_is_not_finite_gives_zero_and_is_counted(bad: float, place: int) -> None:
    compensator = Compensator(make_model())
    inputs = [0.3, 0.3, 0.001, 1.0]
    inputs[place] = bad
    assert compensator.torque(*inputs) == 0.0
    assert compensator.rejected == 1
    assert compensator.torque(0.3) > 0.0


@pytest.mark.parametrize(
    "bad",
    ["0.3", "nan", "", [0.3], (0.3,), np.array([0.3, 0.3]), np.array([0.3]), np.array(math.nan), True, np.True_, 1j],
)
@pytest.mark.parametrize("place", range(8))
def test_what_is_no_number_raises_and_is_counted(bad: Any, place: int) -> None:
    compensator = Compensator(make_model(BidirectionalStribeck(FORWARD, REVERSE), LoadCoulomb(0.1)), torque_rate=100.0)
    inputs: list[Any] = [0.3, 0.3, 0.001, 1.0, 0.1, 0.5, 30.0, 0.1]
    compensator.torque(*inputs)
    with pytest.raises(
        ParameterError, match=r"must be one number, got .* call torque with floats, once for each joint"
    ):
        compensator.torque(*[*inputs[:place], bad, *inputs[place + 1 :]])
    assert compensator.rejected == 1
    assert compensator.rejection.startswith("ParameterError: ")
    assert compensator.torque(*inputs) == pytest.approx(0.1)  # the rate begins at zero again


def test_a_velocity_reference_is_needed() -> None:
    with pytest.raises(ParameterError, match="velocity_reference must be one number, got None"):
        Compensator(make_model()).torque(None)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [int, np.int64, np.float32, np.float64, Fraction])
def test_any_kind_of_real_number_is_taken(kind: Any) -> None:
    compensator = Compensator(make_model(), measured_share=0.5, error_rate=1.0)
    found = compensator.torque(kind(1), kind(1), kind(0), kind(1))
    assert type(found) is float
    assert found == compensator.torque(1.0, 1.0, 0.0, 1.0) != 0.0


def test_a_rejected_input_gives_zero_at_once_whatever_the_rate() -> None:
    compensator = Compensator(make_model(), torque_rate=10.0)
    torques = [compensator.torque(0.3) for _ in range(10)]
    assert torques == pytest.approx([0.01 * k for k in range(1, 11)])
    assert compensator.torque(math.nan) == 0.0
    assert compensator.torque(0.3) == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("term", "needed"),
    [
        (SpringTorque(2.0, 1.0), ("position",)),
        (LoadCoulomb(0.1), ("load_torque",)),
        (KinematicError(1e-3, 0.0, 9.0, 2.0), ("position", "acceleration")),
    ],
)
def test_an_input_that_the_model_depends_on_is_not_taken_for_zero(term: Term, needed: tuple[str, ...]) -> None:
    compensator = Compensator(make_model(Coulomb(0.2), term))
    assert compensator.inputs == set(needed)
    given = dict.fromkeys(needed, 0.5)
    assert compensator.torque(0.3, **given) != 0.0
    for missing in needed:
        known = {name: value for name, value in given.items() if name != missing}
        assert compensator.torque(0.3, **known) == 0.0
    assert compensator.rejected == len(needed)
    assert "missing" in compensator.rejection


def test_hot_path_and_arrays_agree() -> None:
    rng = np.random.default_rng(0)
    reference, velocity, error = rng.normal(size=(3, 300)) * np.array([[0.3], [0.3], [0.005]])
    model = make_model()
    for source, share in (("reference", 0.0), ("blend", 0.4), ("measured", 1.0)):
        given: dict[str, Any] = {"error_rate": 2.0, "error_band": 1e-3, "rest_velocity": 0.05, "dead_band": 0.01}
        compensator = Compensator(model, source=source, measured_share=share, gain=1.0, authority=10.0, **given)
        expected = compute_compensation(split_law(model.law), compensator.settings, reference, velocity, error)
        found = [compensator.torque(*row) for row in zip(reference, velocity, error, strict=True)]
        assert found == pytest.approx(expected.tolist(), abs=1e-12)


def test_stuck_joint_gets_the_breakaway_torque() -> None:
    compensator = Compensator(make_model(), source="reference", gain=1.0, rest_velocity=0.002)
    assert compensator.torque(0.2, 0.0) == pytest.approx(0.60 + 0.02 * 0.2)
    assert compensator.torque(0.2, 0.2) == pytest.approx(float(make_model().torque(0.2)), rel=1e-6)


def test_position_error_gives_a_resting_reference_its_direction() -> None:
    compensator = Compensator(make_model(), error_rate=5.0, error_band=1e-3, gain=1.0)
    assert compensator.torque(0.0, 0.0, 0.5e-3) == 0.0
    assert compensator.torque(0.0, 0.0, 0.02) > 0.5
    assert compensator.torque(0.0, 0.0, -0.02) < -0.5


def test_measured_velocity_within_the_dead_band_is_rest() -> None:
    compensator = Compensator(make_model(), source="measured", velocity_quantum=0.01)
    assert compensator.settings.smoothing >= 0.03
    assert compensator.torque(0.5, 0.01) == 0.0
    assert compensator.torque(0.0, 0.2) > 0.0


@pytest.mark.parametrize("term", [LuGre(FORWARD, REVERSE, 6000.0, 3.0), Dahl(0.4, 5000.0)])
def test_bristle_follows_the_law_step_by_step_and_forgets_on_reset(term: LuGre | Dahl) -> None:
    model = make_model(term)
    compensator, state = Compensator(model, gain=1.0, authority=5.0), model.law.rest_state()
    for velocity in 0.2 * np.sin(np.arange(2000) * 0.004):
        expected, state = model.law.advance(state, OperatingPoint(float(velocity)), 1e-3)
        assert compensator.torque(float(velocity)) == pytest.approx(float(expected), abs=1e-9)
    compensator.reset()
    assert compensator.torque(0.0) == 0.0


def test_terms_that_fit_no_curve_are_added() -> None:
    arctan = SmoothedCoulomb(0.2, 0.01, "arctan")
    model = make_model(BidirectionalStribeck(FORWARD, REVERSE), arctan)
    compensator = Compensator(model, source="reference", gain=1.0)
    assert compensator.torque(0.4) == pytest.approx(float(model.torque(0.4)), rel=1e-6)
    assert compensator.torque(0.0) == 0.0


def test_scales_change_dry_and_viscous_parts() -> None:
    compensator = Compensator(make_model(Coulomb(0.3), Viscous(0.5)), gain=1.0, authority=5.0)
    compensator.set_scale(2.0, 0.5)
    assert compensator.torque(1.0) == pytest.approx(2.0 * 0.3 + 0.5 * 0.5)


def test_reads_a_model_file(tmp_path: Path) -> None:
    save_model(make_model(), tmp_path / "friction.json")
    assert Compensator(tmp_path / "friction.json").torque(0.3) == Compensator(make_model()).torque(0.3)
    with pytest.raises(ModelFileError):
        Compensator(tmp_path / "missing.json")
    with pytest.raises(ParameterError, match="NetworkCompensator"):
        Compensator("friction.onnx")


def test_arm_is_its_joints() -> None:
    joints = [Compensator(make_model()), Compensator(make_model(Coulomb(0.3)))]
    arm, out = ArmCompensator(joints), [9.0, 9.0]
    arm.torque_into(out, [0.1, -0.2])
    assert out == [Compensator(make_model()).torque(0.1), Compensator(make_model(Coulomb(0.3))).torque(-0.2)]
    arm.torque_into(out, [math.nan, 0.1], [0.0, 0.0])
    assert (out[0], arm.rejected) == (0.0, 1)
    with pytest.raises(ParameterError, match="for 2 joints"):
        arm.torque_into(out, [0.1, 0.1], [0.1])
    with pytest.raises(ParameterError, match="at least one"):
        ArmCompensator([])
    with pytest.raises(ParameterError, match="make one for each"):
        ArmCompensator([joints[0], joints[0]])


def test_an_arm_takes_no_model_whose_inputs_it_is_not_told() -> None:
    law = FrictionLaw((Coulomb(0.2), LoadCoulomb(0.1)))
    with pytest.raises(ParameterError, match="depends on load_torque"):
        ArmCompensator([Compensator(FrictionModel(law, validity=Validity(velocity=(-5.0, 5.0))))])


def test_arm_hands_on_every_input() -> None:
    arm, out = ArmCompensator([Compensator(make_model(), error_rate=2.0) for _ in range(2)]), [0.0, 0.0]
    arm.torque_into(out, [0.1, -0.2], [0.1, -0.1], [0.01, 0.0], [1.2, 0.7])
    one = Compensator(make_model(), error_rate=2.0)
    assert out == [one.torque(0.1, 0.1, 0.01, 1.2), one.torque(-0.2, -0.1, 0.0, 0.7)]


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"gain": 3.0}, "gain"),
        ({"smoothing": 0.0}, "smoothing"),
        ({"source": "guess"}, "source"),
        ({"measured_share": 1.5}, "measured_share"),
        ({"torque_rate": -1.0}, "torque_rate"),
        ({"authority": math.nan}, "authority"),
        ({"velocity_range": (2.0, -2.0)}, "velocity_range"),
        ({"velocity_range": (math.nan, 1.0)}, "velocity_range"),
        ({"normal_load_range": (5.0, 1.0)}, "normal_load_range"),
        ({"load_torque_range": (0.0, math.nan)}, "load_torque_range"),
        ({"temperature_range": (40.0, 20.0)}, "temperature_range"),
        ({"acceleration_range": (1.0, -1.0)}, "acceleration_range"),
        ({"colour": "red", "gain": 0.9}, "unknown setting colour; known"),
        ({"smoothing": "0.1"}, "smoothing .*'0.1'"),
        ({"velocity_range": 3.0}, "velocity_range"),
        ({"period": 0.0}, "period"),
    ],
)
def test_bad_settings_are_refused(given: dict[str, Any], match: str) -> None:
    with pytest.raises(ParameterError, match=match):
        Compensator(make_model(), **given)


def test_settings_and_single_fields_exclude_each_other() -> None:
    settings = Compensator(make_model()).settings
    assert Compensator(make_model(), settings=replace(settings, gain=0.5)).settings.gain == 0.5
    with pytest.raises(ParameterError, match="not both"):
        Compensator(make_model(), settings=settings, gain=0.5)
