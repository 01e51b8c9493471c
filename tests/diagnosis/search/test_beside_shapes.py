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
    numbers = found.effects[0].parameters
    assert numbers["edge"].value == pytest.approx(0.3, abs=5e-3)
    # It is met for milliseconds, in which stiffness, hardening and the inertia of the contact make up for each other.
    assert numbers["stiffness"].value == pytest.approx(2000.0, rel=0.25)
    low, high = numbers["stiffness"].ci95
    assert low <= 2000.0 <= high
