"""A refit against the given simulation: names, plain numbers, and one name where one is enough."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint
from fricomp.diagnosis.evidence.comparison import NAMED, PLAIN, UNEXPLAINED, Comparison
from fricomp.diagnosis.evidence.friction_comparison import (
    GivenFriction,
    _describe_uneven,
    _list_level_changes,
    compare_friction,
    list_friction_changes,
)
from fricomp.diagnosis.evidence.rigid_comparison import compare_rigid
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.observer import Plant
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel

_PLANT = Plant(0.3, (1.0, 6.0), 0.0, (2.0, 2.6, 0.05, 1.0), (2.0, 2.6, 0.05, 1.0), 4e4)
_SURE = np.diag([1e-4, 1e-3, 1e-3, 1e-3]) ** 2
_GRAVITY_FOR_OFFSET = np.eye(12)[3] - np.eye(12)[1]
_BRISK, _GENTLE = 10.0, 0.25  # RMS accelerations [rad/s²]


def _given(rigid: RigidJoint | None = None, offset: float = 0.0) -> GivenFriction:
    curve = StribeckCurve(2.0, 2.6, 0.05, 1.0)
    return GivenFriction(FrictionModel(law=FrictionLaw((BidirectionalStribeck(curve, curve),))), offset, rigid)


def _friction(offset: float, odd: float, deviation: float = 1e-3, static: float = 1.0) -> Comparison:
    """The comparison of a refit that found `offset` and half a difference of `odd` between the directions.

    `static` is how much of that the static torque follows.
    """
    forward, reverse = ((2.0 + half, 2.6 + static * half, 0.05, 1.0) for half in (odd, -odd))
    plant = replace(_PLANT, offset=offset, forward=forward, reverse=reverse)
    return compare_friction(plant, np.eye(12) * deviation**2, _given(), "N·m", PLAIN, _BRISK)


def test_a_payload_is_named_in_numbers_that_any_writer_of_json_takes() -> None:
    given = RigidJoint(0.27, (0.9, 5.2), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "payload_error"
    assert effect.parameters["inertia_change"].value == pytest.approx(0.03, abs=1e-3)
    assert effect.parameters["gravity_sin_change"].value == pytest.approx(0.8, abs=0.02)
    assert msgspec.json.decode(msgspec.json.encode(effect))["name"] == "payload_error"


@pytest.mark.parametrize(("inertia", "name"), [(1.197, "torque_gain_error"), (1.23, "payload_error")])
def test_a_factor_is_common_as_far_as_what_moved_strays_by_a_part_of_its_size(inertia: float, name: str) -> None:
    """A torque that acts part of a sample late moved the inertia of a joint by 0.6 % more than its gravity."""
    given = RigidJoint(0.3 / inertia, (1.0 / 1.19, 6.0 / 1.19), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == name


@pytest.mark.parametrize(("gravity", "name"), [(6.008, "inertia_error"), (6.1, "payload_error")])
def test_a_gravity_that_is_off_by_a_trifle_makes_no_other_load_of_another_inertia(gravity: float, name: str) -> None:
    """Of an inertia 18 % too large and a gravity off by 0.2 %, parts of a recording named now this, now that."""
    given = RigidJoint(0.35, (1.0, gravity), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == name


@pytest.mark.parametrize("gravity", [0.0, 1e-9])
@pytest.mark.parametrize(("inertia", "alike"), [(0.285, ("torque_gain_error",)), (0.22, ())])
def test_without_a_gravity_a_factor_is_that_of_the_inertia(gravity: float, inertia: float, alike: tuple[str]) -> None:
    """A simulation whose gravity was 1e-9 N·m had made a payload of an inertia that is off."""
    plant = replace(_PLANT, gravity=(-0.02, -0.01))
    strays = np.diag([1e-4, 0.1, 0.1, 0.1]) ** 2
    given = RigidJoint(inertia, (gravity, gravity), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(plant, strays, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "inertia_error"
    assert effect.alike == alike


def test_a_common_factor_that_is_not_quite_met_is_a_gain_with_another_mass_as_alias() -> None:
    given = RigidJoint(0.3 / 0.966, (1.0 / 0.966, 6.0 / 0.966 - 0.02), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", NAMED, _BRISK).shifts
    assert effect.name == "torque_gain_error"
    assert effect.alike == ("payload_error",)
    assert effect.parameters["gain_error"].value == pytest.approx(-0.034, abs=0.004)


def test_a_common_factor_that_the_inertia_is_not_seen_to_follow_is_a_payload() -> None:
    given = RigidJoint(0.3 / 0.995, (1.0 / 0.995, 6.0 / 0.995), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _GENTLE).shifts
    assert effect.name == "payload_error"
    assert effect.alike == ("torque_gain_error",)


@pytest.mark.parametrize("level", [0.5, 2.0])
def test_a_shift_whose_torque_is_less_than_a_hundredth_of_the_friction_is_none(level: float) -> None:
    """A simulator that damps implicitly makes an inertia larger by its step, however surely that is seen."""
    plant = replace(_PLANT, forward=(level, level, 0.05, 1.0), reverse=(level, level, 0.05, 1.0))
    moved = 0.01 * level / (0.3 * _BRISK)
    for times, named in ((0.8, False), (1.3, True)):
        given = RigidJoint(0.3 / (1.0 + times * moved), (1.0, 6.0), 0.0, 0.0, 0.0, True)
        assert bool(compare_rigid(plant, _SURE, given, "N·m", PLAIN, _BRISK).shifts) is named


_CARRIAGE = replace(_PLANT, inertia=24.0, gravity=(0.0, 0.0), offset=120.0)


def test_the_mass_of_a_level_axis_is_compared_alone() -> None:
    """Nothing of it stands still, and a gain would be another mass, too."""
    given = RigidJoint(20.0, (0.0, 0.0), 0.0, 0.0, 0.0, False)
    found = compare_rigid(_CARRIAGE, _SURE, given, "N", PLAIN, _BRISK)
    (effect,), (change,) = found.shifts, found.changes
    assert (effect.name, effect.sentence) == ("inertia_error", "the mass is 24 kg, not 20")
    assert effect.parameters["inertia_change"].value == pytest.approx(4.0, rel=0.02)
    assert (change.name, change.given, change.refitted.value, change.refitted.unit) == ("inertia", 20.0, 24.0, "kg")
    assert not compare_rigid(_CARRIAGE, _SURE, replace(given, inertia=24.0), "N", PLAIN, _BRISK).shifts


@pytest.mark.parametrize(
    ("mass", "weight", "name"),
    [(20.0, 120.0, "inertia_error"), (22.0, 100.0, "payload_error"), (24.0 / 1.05, 120.0 / 1.05, "torque_gain_error")],
)
def test_what_an_axis_lifts_is_compared_with_its_mass(mass: float, weight: float, name: str) -> None:
    given = RigidJoint(mass, (0.0, 0.0), weight, 0.0, 0.0, False)
    (effect,) = compare_rigid(_CARRIAGE, _SURE, given, "N", PLAIN, _BRISK).shifts
    assert effect.name == name
    if name == "payload_error":
        assert effect.parameters["weight_change"].value == pytest.approx(20.0, rel=0.02)


def test_a_mass_that_alone_is_seen_to_be_off_is_no_gain() -> None:
    """The weight is known so badly that it may or may not follow."""
    given, loose = RigidJoint(24.0 / 1.05, (0.0, 0.0), 120.0 / 1.05, 0.0, 0.0, False), _SURE.copy()
    loose[3, 3] = 100.0
    (effect,) = compare_rigid(_CARRIAGE, loose, given, "N", PLAIN, _BRISK).shifts
    assert effect.name in ("inertia_error", "payload_error")


def test_an_inertia_is_known_the_better_the_more_there_is_to_accelerate() -> None:
    """Friction of slightly another form leans on the inertia by a part of its own torque."""
    given = RigidJoint(0.3 / 1.008, (1.0, 6.0), 0.0, 0.0, 0.0, True)
    (effect,) = compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "inertia_error"
    assert not compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _GENTLE).shifts


def test_what_is_not_explained_casts_doubt_on_parameters() -> None:
    given = RigidJoint(0.3, (1.0, 6.08), 0.0, 0.0, 0.0, True)
    assert compare_rigid(_PLANT, _SURE, given, "N·m", PLAIN, _BRISK).shifts
    assert not compare_rigid(_PLANT, _SURE, given, "N·m", UNEXPLAINED, _BRISK).shifts


@pytest.mark.parametrize("split", [-0.2, 0.0, 0.2])
def test_what_sliding_cannot_split_gets_one_name_and_its_alias(split: float) -> None:
    (effect,) = _friction(0.05 + split, 0.05 - split).shifts
    assert effect.name == "torque_offset"
    assert effect.alike == ("direction_asymmetry",)
    low, high = effect.parameters["offset"].ci95
    assert low < 0.1 < high


def test_static_friction_that_follows_speaks_for_the_directions() -> None:
    (effect,) = _friction(0.2, -0.1, static=0.7).shifts
    assert effect.name == "direction_asymmetry"
    assert effect.alike == ("torque_offset",)
    low, high = effect.parameters["coulomb_difference"].ci95
    assert low < 0.2 < high


def test_a_split_beyond_all_doubt_gets_both_names() -> None:
    effects = _friction(1.5, -1.3).shifts
    assert [effect.name for effect in effects] == ["torque_offset", "direction_asymmetry"]
    assert effects[0].parameters["offset"].value == pytest.approx(1.5, abs=0.1)
    assert effects[1].parameters["coulomb_difference"].value == pytest.approx(-2.6, abs=0.2)
    assert effects[1].parameters["asymmetry"].value == pytest.approx(-0.65, abs=0.05)


def test_friction_of_the_simulation_stands_beside_the_refitted_one_where_they_differ() -> None:
    covariance, units = np.diag(np.full(12, 1e-3)) ** 2, ("N·m", "rad")

    def changes(damping: float, loss: float) -> list[tuple[str, float, float]]:
        given = RigidJoint(0.3, (1.0, 6.0), 0.0, damping, loss, True)
        found = list_friction_changes(_PLANT, covariance, given, units, PLAIN)
        return [(one.name, one.given, one.refitted.value) for one in found]

    assert changes(1.0, 2.0) == []
    assert changes(0.6, 1.5) == [("frictionloss", 1.5, 2.0), ("damping", 0.6, 1.0)]
    assert changes(0.0, 0.0) == []  # its friction is elsewhere


@pytest.mark.parametrize(("half", "words"), [(1.3, "by 2.6 N·m"), (0.3, "by 30 %")])
def test_directions_that_differ_by_more_than_the_level_are_told_in_torque(half: float, words: str) -> None:
    effect = _describe_uneven("direction_asymmetry", half, 0.1, (2.0, "N·m"))
    assert effect.sentence.endswith(words)


def test_a_split_that_leaves_the_sum_as_it_is_names_nothing() -> None:
    assert _friction(0.4, -0.4).shifts == ()
    assert _friction(0.4, -0.4).changes == ()


def test_a_shift_within_the_doubt_of_the_fit_names_nothing() -> None:
    assert _friction(0.1, 0.0).shifts
    assert not _friction(0.1, 0.0, deviation=0.05).shifts


def _hardly_told_from_gravity() -> FloatArray:
    """Covariance of a fit that knows the sum of offset and gravity well, and their difference badly."""
    deviation = np.full(12, 1e-4)
    covariance = np.diag(deviation**2)
    return covariance + 0.03**2 * np.outer(_GRAVITY_FOR_OFFSET, _GRAVITY_FOR_OFFSET)


def test_an_offset_that_gravity_could_fill_in_for_shows_where_gravity_is_as_given() -> None:
    plant = replace(_PLANT, offset=0.04)
    rigid = RigidJoint(0.3, (1.0, 6.0), 0.0, 0.0, 0.0, True)
    covariance = _hardly_told_from_gravity()
    assert not compare_friction(plant, covariance, _given(), "N·m", PLAIN, _BRISK).shifts
    (effect,) = compare_friction(plant, covariance, _given(rigid), "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "torque_offset"
    assert effect.parameters["offset"].value == pytest.approx(0.04, abs=0.005)


@pytest.mark.parametrize(
    ("named", "levels"),
    [
        ({"direction_asymmetry"}, (1.9, 2.3)),
        ({"torque_offset"}, (2.1, 2.1)),
        ({"direction_asymmetry", "torque_offset"}, (2.2, 2.0)),
        (set(), ()),
    ],
)
def test_levels_are_told_with_what_is_not_named_as_it_was_given(named: set[str], levels: tuple[float, ...]) -> None:
    """Sliding shows the sum of a level and the offset, and a fit may have parted them anyhow."""
    plant = replace(_PLANT, offset=-0.2, forward=(2.2, 2.8, 0.05, 1.0), reverse=(2.0, 2.6, 0.05, 1.0))
    covariance = np.diag(np.full(12, 1e-3)) ** 2
    covariance += 0.3**2 * np.outer(*[np.eye(12)[3] - np.eye(12)[4] + np.eye(12)[8]] * 2)
    changes = _list_level_changes(plant, covariance, _given(offset=0.1), "N·m", named)
    assert [one.refitted.value for one in changes] == pytest.approx(levels)
    assert all(one.refitted.ci95[1] - one.refitted.ci95[0] < 0.01 for one in changes) == (len(named) < 2)


def test_an_offset_that_the_simulation_has_itself_is_none() -> None:
    plant = replace(_PLANT, offset=0.3)
    covariance = np.diag(np.full(12, 1e-3)) ** 2
    assert not compare_friction(plant, covariance, _given(offset=0.3), "N·m", PLAIN, _BRISK).shifts
    assert compare_friction(plant, covariance, _given(), "N·m", PLAIN, _BRISK).shifts


def test_gravity_that_is_not_quite_as_given_is_no_offset() -> None:
    """A fit whose offset and gravity strayed together, with nothing missing, and one whose gravity alone is another."""
    rigid = RigidJoint(0.3, (1.0, 6.0), 0.0, 0.0, 0.0, True)
    covariance = _hardly_told_from_gravity()
    astray = replace(_PLANT, offset=0.05, gravity=(0.95, 6.0))
    assert not compare_friction(astray, covariance, _given(rigid), "N·m", PLAIN, _BRISK).shifts
    elsewhere = replace(_PLANT, gravity=(1.0, 6.2))
    assert not compare_friction(elsewhere, covariance, _given(rigid), "N·m", PLAIN, _BRISK).shifts


def test_directions_that_differ_in_shape_alone_get_no_name() -> None:
    """Viscous friction and Stribeck velocity of one direction are others, and its level comes out a little off."""
    plant = replace(_PLANT, forward=(2.01, 2.61, 0.06, 1.3))
    deviation = np.full(12, 1e-3)
    deviation[[4, 8]] = 5e-3
    assert not compare_friction(plant, np.diag(deviation**2), _given(), "N·m", PLAIN, _BRISK).shifts


def test_static_friction_that_differs_more_than_the_level_calls_in_no_offset() -> None:
    """While it slides, the joint shows a sum of both, and one name is enough for it."""
    plant = replace(_PLANT, forward=(2.3, 3.1, 0.05, 1.0), reverse=(1.7, 2.1, 0.05, 1.0))
    covariance = np.diag(np.full(12, 1e-3)) ** 2
    covariance += 0.5**2 * np.outer(*[np.eye(12)[3] - np.eye(12)[4] + np.eye(12)[8]] * 2)
    (effect,) = compare_friction(plant, covariance, _given(), "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "direction_asymmetry"
    assert effect.parameters["coulomb_difference"].value == pytest.approx(0.6, rel=0.1)


def test_a_difference_beside_a_simulation_counts_in_shares_of_the_friction_that_was_found() -> None:
    """A simulation often says that there is friction, and not how much."""
    curve = StribeckCurve(0.02, 0.02, 1.0, 0.0)
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))
    joint = replace(_PLANT, forward=(2.2, 2.86, 0.05, 1.0), reverse=(1.8, 2.34, 0.05, 1.0))
    given = GivenFriction(model, 0.0, exact=False)
    (effect,) = compare_friction(joint, np.eye(12) * 1e-6, given, "N·m", PLAIN, _BRISK).shifts
    assert effect.name == "direction_asymmetry"
    assert effect.parameters["asymmetry"].value == pytest.approx(0.1, abs=0.01)
