"""Friction under load beside a wave of friction over the angle, which imitates it under one load."""

from __future__ import annotations

import pytest

from fricomp.diagnosis.diagnose import diagnose

from ..toy_joint import ToyJoint, recording


@pytest.mark.slow
def test_friction_under_load_is_tried_where_a_wave_has_bent_offset_and_gravity() -> None:
    """It had come as a wave: beside that, a fit of the load's law was given up before it was there."""
    joint = ToyJoint(load_coulomb=0.15, gravity=9.0, phase=0.1)
    answer = diagnose(recording(joint, "small", 30.0, 3))
    assert [one.name for one in answer.effects] == ["load_coulomb"]
    found = answer.effects[0].parameters["coefficient"]
    assert found.value == pytest.approx(joint.load_coulomb, rel=0.05)
    assert found.ci95[0] < joint.load_coulomb < found.ci95[1]
