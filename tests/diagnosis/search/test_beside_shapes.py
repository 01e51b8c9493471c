"""A stop that bends the base far is fitted from the joint as it is beside the stop."""

from __future__ import annotations

import pytest

from fricomp.diagnosis import diagnose

from ..toy_joint import ToyJoint, recording


@pytest.mark.slow
def test_a_stop_that_the_base_takes_for_gravity_is_a_stop() -> None:
    """From a base whose gravity was ten times the true one the fit of a stop went astray, and nothing had a name."""
    joint = ToyJoint(stop=(2000.0, 2.0, 0.3, 2e9), torque_noise=0.02)
    found = diagnose(recording(joint, "rich", 16.0))
    assert [effect.name for effect in found.effects] == ["end_stop"]
    numbers = {name: one.value for name, one in found.effects[0].parameters.items()}
    assert numbers["stiffness"] == pytest.approx(2000.0, rel=0.1)
    assert numbers["edge"] == pytest.approx(0.3, abs=5e-3)
