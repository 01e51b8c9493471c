"""The base model as a vector: there and back, stiffness by its travel, and a prior on the difference of directions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.joint.base import (
    BASE_NAMES,
    BaseModel,
    align_falls,
    even_directions,
    pack,
    straighten_curves,
    unpack,
)
from fricomp.diagnosis.joint.observer import Observer, Plant
from fricomp.diagnosis.joint.settings import JOINT

_PLANT = Plant(
    0.3, (1.0, 6.0), 0.1, (2.0, 2.6, 0.05, 1.0), (2.4, 2.7, 0.04, 1.2), 4e4, sigma_1=40.0, delay=1e-4, sharpness=0.3,
    spread=1.7, creep_velocity=0.01, creep_lead=0.002,
)  # fmt: skip
_COULOMB = [BASE_NAMES.index(f"{side}.coulomb_torque") for side in ("forward", "reverse")]


def _model() -> BaseModel:
    return BaseModel.build_around(_PLANT, delays=(-5e-4, 5e-4), top_speed=1.5, torques=(2.0, 6.0), rotary=True)


def test_a_plant_survives_its_vector() -> None:
    there = unpack(pack(_PLANT))
    np.testing.assert_allclose(there.to_slots(), _PLANT.to_slots(), rtol=1e-12)
    assert (there.gravity, there.offset, there.delay) == (_PLANT.gravity, _PLANT.offset, _PLANT.delay)


def test_a_bristle_keeps_its_travel_when_the_friction_rises() -> None:
    theta = pack(_PLANT)
    theta[_COULOMB] *= 2.0
    assert unpack(theta).sigma_0 == pytest.approx(2.0 * _PLANT.sigma_0)
    softest = _model().box.upper[BASE_NAMES.index("log_breakaway")]
    assert np.exp(softest) == pytest.approx(JOINT.softest_bristle)


def test_friction_without_presliding_is_no_stranger_to_the_base() -> None:
    """The stiffest bristle turns over within a fifth of a sample of 1 kHz where a joint turns at 15 rad/s²."""
    model = _model()
    stiffest = np.exp(model.box.lower[BASE_NAMES.index("log_breakaway")])
    assert np.sqrt(2.0 * 2.0 * stiffest / 15.0) < 2e-4
    start = np.exp(model.start[BASE_NAMES.index("log_breakaway")])
    assert 100.0 * stiffest < start < 0.5 * JOINT.softest_bristle


def test_the_prior_binds_the_difference_of_the_directions_and_not_their_mean() -> None:
    box = _model().box
    both, apart = np.zeros(len(BASE_NAMES)), np.zeros(len(BASE_NAMES))
    both[_COULOMB], apart[_COULOMB] = [1.0, 1.0], [0.5, -0.5]
    assert both @ box.precision @ both == pytest.approx(0.0, abs=1e-12)
    # A difference of a fifth of the mean is one standard deviation, of the Coulomb and of the static torque.
    assert apart @ box.precision @ apart == pytest.approx(2.0 * (1.0 / (0.2 * _PLANT.level)) ** 2)
    excess = [BASE_NAMES.index(f"{side}.excess") for side in ("forward", "reverse")]
    apart[excess] = -apart[_COULOMB]
    assert apart @ box.precision @ apart == pytest.approx((1.0 / (0.2 * _PLANT.level)) ** 2)
    assert box.centre[_COULOMB[0]] == box.centre[_COULOMB[1]]


def test_the_start_lies_inside() -> None:
    model = _model()
    np.testing.assert_array_equal(model.box.clip(model.start), model.start)
    held = [BASE_NAMES.index(name) for name in ("creep_velocity", "creep_lead")]  # but where a fit without is loud
    np.testing.assert_array_equal(np.flatnonzero(model.box.lower >= model.box.upper), held)


@pytest.mark.parametrize(("coulomb", "bound"), [(1e-3, (0.5, 6.0)), (40.0, (6.0, 6.0))])
def test_the_domain_of_friction_is_a_matter_of_the_torque(coulomb: float, bound: tuple[float, float]) -> None:
    """A stop bends the first estimate to hardly any friction, or to more than the drive has ever had."""
    bent = replace(_PLANT, forward=(coulomb, coulomb, 0.05, 1.0), reverse=(coulomb, coulomb, 0.05, 1.0))
    model = BaseModel.build_around(bent, delays=(-5e-4, 5e-4), top_speed=1.5, torques=(2.0, 6.0), rotary=True)
    for index in _COULOMB:
        assert bound[0] <= model.box.upper[index] <= bound[1]
        assert model.start[index] <= model.box.upper[index]


def test_the_domain_of_viscous_friction_reaches_as_far_as_the_torque() -> None:
    """A drive that lags bends the first estimate to hardly any, or to less than none."""
    bent = replace(_PLANT, forward=(0.02, 0.02, 0.05, 0.0), reverse=(0.02, 0.02, 0.05, 0.0))
    model = BaseModel.build_around(bent, delays=(-5e-4, 5e-4), top_speed=1.5, torques=(2.0, 6.0), rotary=True)
    assert model.box.upper[BASE_NAMES.index("forward.viscous_coefficient")] >= 6.0 / 1.5


def test_the_stiffest_bristle_hides_its_travel_from_the_observer() -> None:
    inertia, level = 1.4, 5.0  # a heavy joint: the observer holds its model with 1.4e4 N·m/rad
    model = BaseModel.build_around(
        Plant(inertia, (0.0, 9.0), 0.0, (level, 7.5, 0.04, 3.0), (level, 7.5, 0.04, 3.0), 1e5),
        delays=(-5e-4, 5e-4),
        top_speed=1.5,
        torques=(10.0, 30.0),
        rotary=True,
    )
    breakaway = float(np.exp(model.box.lower[BASE_NAMES.index("log_breakaway")]))
    assert 2.0 * breakaway * inertia * Observer().bandwidth ** 2 < 0.005 * level


def test_evened_directions_slide_as_before() -> None:
    """Sliding feels offset plus or less the Coulomb torque: both sums stay, and effects behind the base stay too."""
    theta = np.append(pack(_PLANT), [7.0, 8.0])
    even = even_directions(theta)
    assert even is not None
    before, after = unpack(theta[:-2]), unpack(even[:-2])
    assert after.forward[0] == pytest.approx(after.reverse[0])
    for sign, curve in ((1.0, "forward"), (-1.0, "reverse")):
        slid = [one.offset + sign * getattr(one, curve)[0] for one in (before, after)]
        assert slid[0] == pytest.approx(slid[1])
    assert after.compute_static_torque(np.array(1.0), np.array(0.0)) != before.compute_static_torque(
        np.array(1.0), np.array(0.0)
    )
    np.testing.assert_array_equal(even[-2:], [7.0, 8.0])
    assert even_directions(even) is None


def test_a_direction_whose_stribeck_velocity_ran_away_gets_that_of_the_other() -> None:
    alike = replace(_PLANT, forward=(2.0, 3.0, 0.05, 1.0), reverse=(2.2, 3.4, 0.1, 1.1))
    assert align_falls(pack(alike)) is None
    ran = align_falls(np.append(pack(replace(alike, reverse=(2.2, 2.3, 1.9, 1.1))), 7.0))
    assert ran is not None
    after = unpack(ran[:-1])
    assert after.reverse == pytest.approx((2.2, 3.2, 0.05, 1.1))
    assert after.forward == pytest.approx(alike.forward)
    assert ran[-1] == 7.0


def test_a_direction_that_lost_its_static_friction_gets_that_of_the_other() -> None:
    """Without an excess its Stribeck velocity says nothing, however near it is, and the other one is to go by."""
    lost = align_falls(pack(replace(_PLANT, forward=(2.0, 3.0, 0.05, 1.0), reverse=(2.2, 2.2, 0.04, 1.1))))
    assert lost is not None
    assert unpack(lost).reverse == pytest.approx((2.2, 3.2, 0.05, 1.1))


def test_a_bristle_is_no_softer_for_a_fall_of_the_friction_that_has_taken_the_place_of_its_level() -> None:
    """With a Coulomb torque of 0.0002 N·m and a fall of 0.06 a base had taken up a bristle of 8 mrad, and a joint that
    was told to lack nothing left a third of its friction."""
    theta = pack(_PLANT)
    theta[_COULOMB], theta[[i + 1 for i in _COULOMB]] = 1e-3, 2.4
    plant = unpack(theta)
    static = 0.5 * (plant.forward[1] + plant.reverse[1])
    assert static / plant.sigma_0 == pytest.approx(2.0 * np.exp(theta[BASE_NAMES.index("log_breakaway")]), rel=0.01)
    np.testing.assert_allclose(pack(plant), theta, rtol=1e-12)


def test_friction_that_falls_over_all_of_the_motion_becomes_a_line_with_a_fall_at_low_speeds() -> None:
    """A Coulomb torque of 3.4 and 1.7 of drag had become a fall with twice the drag, the other direction not."""
    plant = replace(_PLANT, forward=(0.3, 3.3, 0.8, 4.5), reverse=(3.4, 3.7, 0.05, 1.7))
    straight = straighten_curves(np.append(pack(plant), 7.0), usual_speed=1.3)
    assert straight is not None
    after, speed = unpack(straight[:-1]), np.linspace(0.3, 1.3, 30)
    coulomb, breakaway, width, viscous = after.forward
    curve = 0.3 + 3.0 * np.exp(-((speed / 0.8) ** 2)) + 4.5 * speed
    assert coulomb + viscous * speed == pytest.approx(curve, abs=0.25)
    assert coulomb > 2.0
    assert width < 0.2
    assert breakaway == pytest.approx(max(3.3, coulomb))
    assert after.reverse == pytest.approx(plant.reverse)
    assert straight[-1] == 7.0
    assert straighten_curves(straight, usual_speed=1.3) is None
