"""The simulated drive closes its loops like a drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.errors import ParameterError
from fricomp.joint import CommandMode
from fricomp.sim_bench.stand_in import ServoSettings, StandIn, default_joint


def drive(stand_in: StandIn, mode: CommandMode, duration: float, **command: float) -> np.ndarray:
    """True velocity of the first joint over time, with the drive commanded every period."""
    stand_in.enable(mode)
    velocities = []
    for _ in range(round(duration / stand_in.settings.period)):
        stand_in.servos[0].command(command.get("torque", 0.0), command.get("velocity", 0.0), command.get("position", 0))
        stand_in.step()
        velocities.append(stand_in.plant.velocity(0))
    return np.array(velocities)


@pytest.mark.parametrize("velocity", [0.005, 0.03, 0.05, -0.03, -0.05, 0.5])
def test_velocity_loop_slides_smoothly_on_the_falling_branch(velocity: float) -> None:
    settled = drive(StandIn(default_joint()), "velocity", 2.0, velocity=velocity)[700:]
    assert settled.mean() == pytest.approx(velocity, rel=3e-3)
    assert (settled * np.sign(velocity)).min() > 0.5 * abs(velocity)


def test_a_weak_velocity_loop_sticks_and_slips_there() -> None:
    settings = default_joint()
    weak = replace(settings.joints[0], servo=ServoSettings(bandwidth=20.0))
    settled = drive(StandIn(replace(settings, joints=(weak,))), "velocity", 3.0, velocity=0.03)[1000:]
    assert (np.abs(settled) < 1e-4).any()
    assert settled.max() > 0.06


def test_position_loop_reaches_its_target() -> None:
    stand_in = StandIn(default_joint())
    drive(stand_in, "position", 1.0, position=0.7)
    assert stand_in.plant.position(0) == pytest.approx(0.7, abs=2.0 * 0.6 / stand_in.servos[0].stiffness)


def test_torque_feed_forward_adds_to_the_loop() -> None:
    with_it, without = StandIn(default_joint()), StandIn(default_joint())
    drive(with_it, "velocity", 0.02, velocity=0.5, torque=0.3)
    drive(without, "velocity", 0.02, velocity=0.5)
    assert with_it.plant.velocity(0) > without.plant.velocity(0) + 0.001


def test_reference_ramps_within_the_acceleration_limit() -> None:
    velocities = drive(StandIn(default_joint()), "position", 1.0, position=1.0)
    assert 3.0 < velocities.max() < 5.0
    assert np.diff(velocities).max() < 2.0 * 20.0 * 1e-3


def test_torque_is_limited_by_the_drive() -> None:
    stand_in = StandIn(default_joint())
    drive(stand_in, "torque", 0.01, torque=99.0)
    assert stand_in.torque == [5.0]
    drive(stand_in, "position", 0.01, position=-3.0)
    assert stand_in.torque == [-5.0]


def test_enabling_holds_still_whatever_was_commanded_before() -> None:
    stand_in = StandIn(default_joint())
    stand_in.servos[0].command(4.0, 4.0, 1.0)
    stand_in.enable("position")
    for _ in range(50):
        stand_in.step()
    assert abs(stand_in.plant.position(0)) < 1e-6


def test_silence_beyond_the_watchdog_takes_the_torque_away() -> None:
    stand_in = StandIn(default_joint())
    stand_in.enable("torque")
    stand_in.servos[0].command(2.0)
    torques = []
    for _ in range(150):
        stand_in.step()
        torques.append(stand_in.torque[0])
    assert torques[:95] == [2.0] * 95
    assert torques[101:] == [0.0] * 49
    assert stand_in.servos[0].expired


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="bandwidth must be positive"):
        ServoSettings(bandwidth=0.0)
