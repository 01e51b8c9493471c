"""How far a joint comes before the gate stops it is bounded, and told by `fricomp check-loop`."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.control import JointLimits, LoopDynamics
from fricomp.control.gate.failure_travel import FAILURES, bound_travel

LOOP = LoopDynamics(inertia=0.1, stiffness=98.7, damping=6.28, delay=0.002)
LIMITS = JointLimits(torque=5.0, torque_rate=250.0, velocity=8.0, position=(-3.0, 3.0))


def test_every_failure_is_found_and_the_travel_is_what_physics_allows() -> None:
    found = bound_travel(LOOP, LIMITS, 1e-3)
    assert found.keys() == FAILURES.keys()
    # From rest at full torque to the velocity limit: J v² / 2 u, and what the torque's rise and the delay add.
    shortest = LOOP.inertia * LIMITS.velocity**2 / (2.0 * LIMITS.torque)
    assert shortest < found["full torque"] < 1.3 * shortest
    # 50 ms at full speed, faster by what full torque makes of it.
    assert found["sensor frozen at full speed"] < 8.0 * 0.05 + 0.5 * 50.0 * 0.05**2
    # To where the mirrored loop saturates, and on for the time that a runaway takes to be told from a load.
    assert LIMITS.torque / LOOP.stiffness < found["sensor mirrored"] < 0.3


def test_a_lower_torque_limit_shortens_the_way_of_a_mirrored_joint() -> None:
    low = bound_travel(LOOP, replace(LIMITS, torque=2.0), 1e-3)["sensor mirrored"]
    assert low < bound_travel(LOOP, LIMITS, 1e-3)["sensor mirrored"]


@pytest.mark.parametrize("period", [5e-4, 1e-3, 5e-3])
def test_the_bound_holds_at_every_rate(period: float) -> None:
    assert all(travel < 1.0 for travel in bound_travel(LOOP, LIMITS, period).values())
