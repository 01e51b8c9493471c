"""The joint that was found as another first estimate: where it is far from the first one and something is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.joint.base import BASE_NAMES
from fricomp.diagnosis.search.again.late_joint import find_far_joint, measure_left
from fricomp.diagnosis.search.preparation import Baseline

from ..known import PLANT, known_baseline, known_fit, known_search


@pytest.mark.parametrize(
    ("times", "loudness", "coverage", "far"),
    [
        (5.0, 3.0, 0.9, True),
        (0.2, 3.0, 0.9, True),
        (1.5, 3.0, 0.9, False),
        (5.0, 1.0, 0.9, False),
        (5.0, 3.0, 0.5, False),
    ],
)
def test_a_joint_is_far_by_its_inertia_where_it_covers_most_and_more_than_noise_is_left(
    times: float, loudness: float, coverage: float, far: bool
) -> None:
    baseline = known_baseline(loudness=loudness)
    found = known_search(known_fit(baseline, ("cogging",), 900.0, coverage=coverage))
    moved = _move_estimate(baseline, times)
    joint = find_far_joint(moved, found)
    assert (joint is not None) == far
    if joint is not None:
        assert joint.inertia == pytest.approx(PLANT.inertia)
    simulation = RigidJoint(PLANT.inertia, PLANT.gravity, 0.0, 0.0, 0.0, True)
    assert find_far_joint(replace(moved, rigid=simulation), found) is None


def test_a_joint_without_dry_friction_is_no_start() -> None:
    """Its bristle has no stiffness, and a motor at one speed was found so."""
    baseline = _move_estimate(known_baseline(loudness=3.0), 5.0)
    fit = known_fit(baseline, ("cogging",), 900.0, coverage=0.9)
    theta = fit.fit.theta.copy()
    theta[[BASE_NAMES.index(f"{side}.coulomb_torque") for side in ("forward", "reverse")]] = 0.0
    frictionless = replace(fit, fit=replace(fit.fit, theta=theta))
    assert find_far_joint(baseline, known_search(fit)) is not None
    assert find_far_joint(baseline, known_search(frictionless)) is None


def test_where_nothing_was_found_there_is_no_other_joint_and_the_base_tells_what_is_left() -> None:
    baseline = _move_estimate(known_baseline(loudness=3.0), 5.0)
    nothing = known_search(best=False)
    assert find_far_joint(baseline, nothing) is None
    assert measure_left(baseline, nothing) == pytest.approx(baseline.noise_ratio)


def _move_estimate(baseline: Baseline, times: float) -> Baseline:
    """The same base, whose first estimate had so many times its inertia."""
    centre = baseline.box.centre.copy()
    centre[0] += np.log(times)
    return replace(baseline, box=replace(baseline.box, centre=centre))
