"""What is compared with a simulation that says nothing of friction."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.diagnosis.inputs.rigid import RigidJoint
from fricomp.diagnosis.joint.base import BASE_NAMES

from ..known import known_baseline, known_case


@pytest.mark.parametrize(("part", "stated"), [(0.3, False), (-0.9, False), (1.3, True), (-1.3, True)])
def test_a_constant_torque_is_compared_where_friction_alone_would_push(part: float, stated: bool) -> None:
    """A difference between the directions of less than all of the friction may be friction."""
    baseline = known_baseline()
    theta = baseline.fit.theta.copy()
    levels = [BASE_NAMES.index(f"{side}.coulomb_torque") for side in ("forward", "reverse")]
    theta[levels], theta[[one + 1 for one in levels]] = 2.0, 0.0  # no static friction above it
    theta[BASE_NAMES.index("offset")] = 0.5 + 2.0 * part
    moved = replace(baseline, fit=replace(baseline.fit, theta=theta))
    case = known_case(moved, rigid=RigidJoint(0.4, (1.5, 2.5), 0.5, 0.0, 0.0, True))
    assert (case.stated_friction is not None) == stated
