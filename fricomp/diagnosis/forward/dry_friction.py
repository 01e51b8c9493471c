"""Friction of a joint that is simulated forward: its curve, and the three ways in which its dry part acts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import copysign, exp, sqrt

from ..joint.observer import Plant
from .settings import FORWARD

_LEAST_FALL = exp(-FORWARD.fallen)


class FrictionCurve:
    """Dry level and viscous torque, which follow the velocity late where the plant has a lag."""

    def __init__(self, plant: Plant, step: float, velocity: float) -> None:
        self.forward, self.reverse = plant.forward, plant.reverse
        self.exponent, self.felt = plant.stribeck_exponent, velocity
        self.keep = exp(-step / plant.lag) if plant.lag > 0.0 else 0.0

    def follow(self, w: float) -> tuple[float, float]:
        """Level and viscous torque [N·m] over the next step, at velocity `w` [rad/s]."""
        self.felt = w + (self.felt - w) * self.keep
        coulomb, static, speed, viscous = self.forward if w >= 0.0 else self.reverse
        power = abs(self.felt / speed) ** self.exponent
        fall = exp(-power) if power < FORWARD.fallen else _LEAST_FALL
        return coulomb + (static - coulomb) * fall, viscous * self.felt


class DryFriction(ABC):
    """What turns the level of dry friction into a torque."""

    @abstractmethod
    def follow(self, w: float, level: float, net: float) -> tuple[float, float]:
        """Torque that opposes the drive over the next step, and level of MuJoCo's own friction loss [N·m].

        Args:
            w: Velocity [rad/s].
            level: Level of dry friction [N·m].
            net: Torque on the motor side without it [N·m].
        """


def build_dry_friction(plant: Plant, inertia: float, step: float, net: float) -> DryFriction:
    """Dry friction of `plant` on a motor side of `inertia` [kg·m²], which holds `net` [N·m] at the start."""
    if plant.creep_velocity > 0.0:
        return _Creep(plant, inertia, step)
    soft = compute_bristle_rate(plant, inertia) * step <= FORWARD.soft_bristle
    return _Bristle(plant, step, net) if soft else _FrictionLoss()


def compute_bristle_rate(plant: Plant, inertia: float) -> float:
    """Rate of an `inertia` [kg·m²] on the bristle of `plant` [1/s]: of its swing, or of its damping."""
    stiffest = (plant.spread + 1.0 + 1.0 / plant.spread) / 3.0
    stiffness = plant.sigma_0 * (1.0 + plant.sharpness * (stiffest - 1.0))
    return max(sqrt(stiffness / inertia), 2.0 * plant.sigma_1 / inertia)


class _FrictionLoss(DryFriction):
    """MuJoCo's own, which holds a joint without any presliding."""

    def follow(self, w: float, level: float, net: float) -> tuple[float, float]:
        return 0.0, level


class _Bristle(DryFriction):
    """The bristle of `kernel`: a share that yields gradually, advanced exactly over the step, and three elements that
    yield at their level, each at the torque where it ends."""

    def __init__(self, plant: Plant, step: float, net: float) -> None:
        self.stiffness, self.damping, self.step = plant.sigma_0, plant.sigma_1 / step, step
        self.sharpness, self.spread = plant.sharpness, plant.spread
        self.gradual = self.first = self.second = self.third = self.mean = net / plant.sigma_0

    def follow(self, w: float, level: float, net: float) -> tuple[float, float]:
        limit, way = level / self.stiffness, w * self.step
        steady = limit if w >= 0.0 else -limit
        self.gradual = mean = steady + (self.gradual - steady) * exp(-abs(way) / limit)
        if self.sharpness > 0.0:
            # Comparisons cost a part of what `min` and `max` do, and a forward simulation takes 100,000 of these steps.
            first, second, third = self.first + self.spread * way, self.second + way, self.third + way / self.spread
            self.first = first if -limit < first < limit else copysign(limit, first)
            self.second = second if -limit < second < limit else copysign(limit, second)
            self.third = third if -limit < third < limit else copysign(limit, third)
            mean += self.sharpness * ((self.first + self.second + self.third) / 3.0 - mean)
        torque = self.stiffness * mean + self.damping * (mean - self.mean)
        self.mean = mean
        return torque, 0.0


class _Creep(DryFriction):
    """The friction of `kernel` that never holds, `compute_creep_friction`: in plain Python a single step of it costs a
    third of that call."""

    def __init__(self, plant: Plant, inertia: float, step: float) -> None:
        self.speed, self.ahead, self.mobility = plant.creep_velocity, step + plant.creep_lead, 1.0 / inertia
        self.bend = self.speed * plant.sharpness * (2.0 - plant.sharpness)

    def follow(self, w: float, level: float, net: float) -> tuple[float, float]:
        driven, slip = w + self.ahead * net * self.mobility, self.ahead * self.mobility
        bend, wide = self.bend + level * slip, abs(driven) + self.speed + level * slip
        return 2.0 * level * driven / (wide + sqrt(max(wide * wide - 4.0 * bend * abs(driven), 0.0))), 0.0
