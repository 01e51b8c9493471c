"""The velocity mode of MIT motors: damping in the motor, stiffness here, nothing lost to rounding, nothing beyond."""

from __future__ import annotations

import random
import struct
from dataclasses import replace
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


def table(model: str = "damiao/DM4310", **extra: Any) -> MitConfiguration:
    joints = joint_tables(1, LIMIT, 8.0, model=model, **extra)
    return convert({"bus": {"interface": "virtual"}, "joints": joints}, MitConfiguration)


def motor(**extra: Any) -> Any:
    return make_motor(table(**extra).joints[0])


def understood(frame: Any, made: Any, moving: float) -> tuple[float, float]:
    """Torque that a motor at a velocity makes of a command, and the damping it was sent."""
    r = made.ranges
    if frame.extended:
        _, velocity, kp, kd = (code / 65535 for code in struct.unpack(">4H", frame.data))
        torque = (frame.identifier >> 8 & 0xFFFF) / 65535
    else:
        bits = int.from_bytes(frame.data, "big")
        velocity, kp, kd, torque = ((bits >> shift & 0xFFF) / 4095 for shift in (36, 24, 12, 0))
    assert kp == 0.0
    damping = kd * r.kd
    return damping * ((2.0 * velocity - 1.0) * r.velocity - moving) + (2.0 * torque - 1.0) * r.torque, damping


def reported(made: Any, moving: float) -> float:
    """A velocity as the motor's state tells it."""
    step, most = made.quanta[1], made.ranges.velocity
    return float(round((moving + most) / step) * step - most)


def test_what_rounding_takes_off_the_reference_is_sent_as_torque() -> None:
    rng, made = random.Random(1), motor()
    gains = loop_gains(60.0, 4.0, made, "joint")
    assert gains is not None
    for _ in range(300):
        velocity, moving, torque = rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.5, 0.5)
        loop = MotorVelocityLoop(made, gains, LIMIT, PERIOD, 0.1)
        wanted = gains.stiffness * velocity * PERIOD + gains.damping * (velocity - moving) + torque
        exerted, damping = understood(loop.frame(velocity, torque, 0.1, moving, now_ns=0), made, moving)
        assert damping == pytest.approx(gains.damping)
        assert exerted == pytest.approx(wanted, abs=0.51 * made.quanta[2])


@pytest.mark.parametrize("model", ["damiao/DM4310", "damiao/DMH3510", "tmotor/AK80-64", "xiaomi/CyberGear"])
@pytest.mark.parametrize("share", [0.1, 0.5, 1.0])
def test_no_reference_and_no_motion_in_the_whole_range_demand_more_than_the_limit(model: str, share: float) -> None:
    rng, made = random.Random(2), motor(model=model)
    limit, fastest = share * made.ranges.torque, made.ranges.velocity
    gains = loop_gains(60.0, min(made.ranges.kd, 0.2 * made.ranges.torque / made.quanta[1]), made, "joint")
    assert gains is not None
    coarse = 0.5 * (made.quanta[2] + gains.damping * made.quanta[1])
    loop, most = MotorVelocityLoop(made, gains, limit, PERIOD, 0.0), 0.0
    edges = [(velocity, moving) for velocity in (-fastest, 0.0, fastest) for moving in (-fastest, 0.0, fastest)]
    anywhere = [(rng.uniform(-fastest, fastest), rng.uniform(-fastest, fastest)) for _ in range(3000)]
    for cycle, (velocity, moving) in enumerate(edges + anywhere):
        torque, at = rng.uniform(-limit, limit), rng.uniform(-3.0, 3.0)
        frame = loop.frame(velocity, torque, at, reported(made, moving), now_ns=round(cycle * PERIOD * 1e9))
        exerted, _ = understood(frame, made, moving)
        most = max(most, abs(exerted))
    assert most <= max(limit, coarse) + 1e-9
    assert most > limit - 2.0 * coarse, "the loop does not use what it may"


def test_a_part_of_the_limit_is_the_whole_of_it_while_the_ramp_lasts() -> None:
    made = motor()
    loop = MotorVelocityLoop(made, LoopGains(60.0, 5.0), LIMIT, PERIOD, 0.0)
    for share in (0.0, 0.25, 0.5, 1.0):
        exerted, _ = understood(loop.frame(8.0, LIMIT, 0.0, 0.0, share, now_ns=0), made, 0.0)
        assert exerted == pytest.approx(share * LIMIT, abs=0.05)
        assert exerted <= max(share * LIMIT, made.quanta[2])


def test_commands_that_come_too_fast_do_not_move_the_reference_faster() -> None:
    made, speed = motor(), 0.5
    torques = []
    for commands in (1, 10):
        loop = MotorVelocityLoop(made, LoopGains(60.0, 1.0), LIMIT, PERIOD, 0.0)
        for step in range(20 * commands):
            frame = loop.frame(speed, 0.0, 0.0, 0.0, now_ns=round(step * PERIOD * 1e9 / commands))
        torques.append(understood(frame, made, 0.0)[0])
    assert torques[0] == pytest.approx(speed + 60.0 * speed * 20 * PERIOD, abs=made.quanta[2])
    assert torques[1] == pytest.approx(torques[0], abs=1.5 * 60.0 * speed * PERIOD)


def test_jitter_does_not_slow_the_reference_down() -> None:
    made, speed = motor(), 0.5
    loop = MotorVelocityLoop(made, LoopGains(60.0, 1.0), LIMIT, PERIOD, 0.0)
    for step in range(40):
        late = 0.2 if step % 2 else 0.0
        frame = loop.frame(speed, 0.0, 0.0, 0.0, now_ns=round((step + late) * PERIOD * 1e9))
    exerted, _ = understood(frame, made, 0.0)
    assert exerted == pytest.approx(speed + 60.0 * speed * 40 * PERIOD, abs=60.0 * speed * PERIOD)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_no_value_that_is_not_finite_moves_the_reference(value: float) -> None:
    made = motor()
    loop = MotorVelocityLoop(made, LoopGains(60.0, 5.0), LIMIT, PERIOD, 0.0)
    for place in range(5):
        values = [0.0, 0.0, 0.0, 0.0, 1.0]
        values[place] = value
        with pytest.raises(AdapterValueError):
            loop.frame(*values, now_ns=0)
    exerted, _ = understood(loop.frame(0.0, 0.0, 0.0, 0.0, now_ns=0), made, 0.0)
    assert abs(exerted) <= made.quanta[2]


@pytest.mark.parametrize("gains", [{"stiffness": 10.0}, {"damping": 1.0}, {"stiffness": 10.0, "damping": 5.1}])
def test_gains_that_the_motor_does_not_take_are_refused_by_name(gains: dict[str, Any]) -> None:
    with pytest.raises(AdapterConfigurationError, match="joint 0"):
        MitAdapter(table(**gains))


def test_a_damping_too_coarse_for_the_torque_range_is_refused() -> None:
    made = motor(ranges=[12.5, 1000.0, 2.0])
    with pytest.raises(AdapterConfigurationError, match="lower the damping"):
        loop_gains(60.0, 5.0, made, "joint")


def test_the_joint_never_gets_more_than_the_ramp_allows_however_fast_the_reference() -> None:
    adapter, limit, ramp = TwinMitAdapter.from_configuration({}), 1.0, 0.1
    limits = tuple(replace(each, torque=limit, breakaway=5.0) for each in adapter.options.limits)
    whole, cut = adapter.options, replace(adapter.options, limits=limits, ramp_time=ramp)
    with adapter:
        adapter.options = cut
        adapter.configure("velocity", PERIOD)
        adapter.options = replace(whole, ramp_time=0.0)  # the gate has taken the others
        adapter.enable()
        command, feedback = JointCommand(1), JointFeedback(1)
        command.velocity[0] = limits[0].velocity
        applied = []
        for _ in range(100):
            assert adapter.write(command)
            adapter.clock.sleep_until(adapter.clock.now_ns() + round(PERIOD * 1e9))
            adapter.read_into(feedback)
            applied.append(abs(adapter.twin.stand_in.torque[0]))
    one_step = 0.045  # of torque, and of velocity times the damping: zero has no code
    assert all(torque <= limit * cycle * PERIOD / ramp + one_step for cycle, torque in enumerate(applied))
    assert 0.8 * limit < max(applied) <= limit


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
