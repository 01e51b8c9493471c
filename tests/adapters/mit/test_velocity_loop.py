"""The velocity mode of MIT motors: damping in the motor, stiffness here, nothing lost to rounding, nothing beyond."""

from __future__ import annotations

import random
from typing import Any

import pytest

from fricomp.adapters.configuration import convert
from fricomp.adapters.mit import MitAdapter
from fricomp.adapters.mit.configuration import MitConfiguration, make_motor
from fricomp.adapters.mit.velocity_loop import LoopGains, MotorVelocityLoop, loop_gains
from fricomp.errors import AdapterConfigurationError, AdapterValueError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.twins.backend import TwinMitAdapter
from tests.adapters.peers.rig import joint_tables

PERIOD, LIMIT = 0.002, 4.0


def table(**extra: Any) -> MitConfiguration:
    joints = joint_tables(1, LIMIT, 8.0, model="damiao/DM4310", **extra)
    return convert({"bus": {"interface": "virtual"}, "joints": joints}, MitConfiguration)


def motor() -> Any:
    return make_motor(table().joints[0])


def understood(frame: Any, at: float, moving: float) -> tuple[float, float]:
    """Torque that a motor at a position and velocity makes of a command, and the damping it was sent."""
    bits = int.from_bytes(frame.data, "big")
    velocity = (bits >> 36 & 0xFFF) / 4095 * 60.0 - 30.0
    stiffness, damping = (bits >> 24 & 0xFFF) / 4095 * 500.0, (bits >> 12 & 0xFFF) / 4095 * 5.0
    assert stiffness == 0.0
    return damping * (velocity - moving) + (bits & 0xFFF) / 4095 * 20.0 - 10.0, damping


def test_what_rounding_takes_off_the_reference_is_sent_as_torque() -> None:
    rng, made = random.Random(1), motor()
    gains = loop_gains(60.0, 4.0, made, "joint")
    assert gains is not None
    for _ in range(300):
        velocity, moving, torque = rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.5, 0.5)
        loop = MotorVelocityLoop(made, gains, LIMIT, PERIOD, 0.1)
        wanted = gains.stiffness * velocity * PERIOD + gains.damping * (velocity - moving) + torque
        exerted, damping = understood(loop.frame(velocity, torque, 0.1, moving), 0.1, moving)
        assert damping == pytest.approx(gains.damping)
        assert exerted == pytest.approx(wanted, abs=0.51 * made.quanta[2])


def test_no_reference_and_no_motion_demand_more_than_the_limit() -> None:
    rng, made = random.Random(2), motor()
    loop = MotorVelocityLoop(made, LoopGains(500.0, 5.0), LIMIT, PERIOD, 0.0)
    for _ in range(500):
        at, moving = rng.uniform(-3.0, 3.0), rng.uniform(-1.0, 1.0)
        exerted, _ = understood(loop.frame(rng.uniform(-1.0, 1.0), rng.uniform(-LIMIT, LIMIT), at, moving), at, moving)
        assert abs(exerted) <= LIMIT + made.quanta[2]


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_reference_that_is_not_finite_is_never_encoded(value: float) -> None:
    with pytest.raises(AdapterValueError):
        MotorVelocityLoop(motor(), LoopGains(60.0, 5.0), LIMIT, PERIOD, 0.0).frame(value, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("gains", [{"stiffness": 10.0}, {"damping": 1.0}, {"stiffness": 10.0, "damping": 5.1}])
def test_gains_that_the_motor_does_not_take_are_refused_by_name(gains: dict[str, float]) -> None:
    with pytest.raises(AdapterConfigurationError, match="joint 0"):
        MitAdapter(table(**gains))


def test_velocity_mode_is_offered_with_gains_only_and_slides_as_told() -> None:
    adapter = TwinMitAdapter.from_configuration({"sim": {"seed": 3}})
    with adapter:
        assert adapter.capabilities.modes == ("torque", "velocity")
        adapter.configure("velocity", PERIOD)
        adapter.enable()
        command, feedback = JointCommand(1), JointFeedback(1)
        command.velocity[0] = 0.5
        for _ in range(750):
            assert adapter.write(command)
            adapter.clock.sleep_until(adapter.clock.now_ns() + round(PERIOD * 1e9))
            adapter.read_into(feedback)
        assert adapter.twin.stand_in.plant.velocity(0) == pytest.approx(0.5, rel=0.02)
    assert "velocity" not in MitAdapter(table())._modes()
