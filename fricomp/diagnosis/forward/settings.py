"""Numbers that decide in this stage, each with its reason and what moves with it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ForwardSettings:
    """How a joint is simulated forward, and which part of a recording it is compared with."""

    soft_bristle: float = 0.5
    """Largest product of a bristle's rate and the step with which its torque is applied. It is stable up to 2."""
    fallen: float = 50.0
    """Power of the Stribeck curve beyond which it has fallen."""
    held_out: float = 1.0 / 3.0
    """Part of the recording that is simulated, at its end."""
    longest: float = 20.0
    """Longest stretch that is simulated [s]; more takes time and says no more."""
    gap: float = 0.5
    """Time between the rows that are fitted and the stretch [s], so that no row reaches into it."""
    slow_sampling: float = 1.5
    """Steps of a track beyond which samples are further apart than it."""
    settling: float = 0.1
    """Part of the stretch in which the initial state dies out."""
    longest_step: float = 2e-4
    """Longest step of the simulation [s]."""
    shortest_step: float = 1e-4
    """Shortest step of the simulation [s]; a shorter one takes too long."""
    fine: float = 0.25
    """Angle of the fastest oscillation in a step [rad]."""
    least_motor_share: float = 0.01
    """Part of the inertia that stays on the motor side at least, so that the simulation is stable."""
    least_level: float = 1e-9
    """Least dry friction [N·m], so that none is divided by."""


FORWARD = ForwardSettings()
