"""What the stand-in is worth, measured: creep, passivity, Stribeck curve, speed."""

import time
from dataclasses import dataclass

import numpy as np

from .plant import Plant
from .stand_in import StandIn, StandInSettings

__all__ = ["StandInFigures", "measure"]

CURVE_SPEEDS = (0.002, 0.01, 0.03, 0.05, 0.1, 0.3, 1.0)
WINDOW = 10
# The speed is that of the fastest of so many stretches: what others on the machine take is not the stand-in's.
STRETCHES = 30


@dataclass(frozen=True)
class StandInFigures:
    """Of the first joint.

    Attributes:
        creep: Fastest motion in the last second under 90 % of breakaway torque, both directions [rad/s].
        largest_power: Largest friction torque times end-of-step velocity in random motions [W]; never positive.
        largest_work: Largest net work of friction over 10 steps there [J].
        curve_error: Largest error of the friction torque in steady sliding against the law [1].
        real_time_factor: Simulated over processor time, drive and sensors included, best of 30 stretches of 0.3 s [1].
    """

    creep: float
    largest_power: float
    largest_work: float
    curve_error: float
    real_time_factor: float


def measure(settings: StandInSettings, *, seed: int = 0, seconds: float = 20.0) -> StandInFigures:
    """Measure a stand-in with one joint, without gravity on it.

    Args:
        settings: The stand-in.
        seed: Of the random motion.
        seconds: Length of the random motion [s].
    """
    stand_in = StandIn(settings)
    plant = stand_in.plant
    power, work = _passivity(plant, seed, seconds)
    return StandInFigures(
        creep=max(_creep(plant, direction) for direction in (1.0, -1.0)),
        largest_power=power,
        largest_work=work,
        curve_error=max(_curve_error(plant, sign * speed) for speed in CURVE_SPEEDS for sign in (1.0, -1.0)),
        real_time_factor=max(_speed(stand_in) for _ in range(STRETCHES)),
    )


def _creep(plant: Plant, direction: float) -> float:
    plant.reset([0.0])
    breakaway = float(plant.frictions[0].law.torque(direction * 1e-9))
    for _ in range(2000):
        plant.step([0.9 * breakaway])
    before = plant.position(0)
    for _ in range(1000):
        plant.step([0.9 * breakaway])
    return abs(plant.position(0) - before) / (1000 * plant.period)


def _passivity(plant: Plant, seed: int, seconds: float) -> tuple[float, float]:
    generator, power = np.random.default_rng(seed), []
    plant.reset([0.0])
    for _ in range(round(seconds / plant.period / 20)):
        torque = float(generator.normal(scale=1.5)) - 2.0 * plant.position(0)
        for _ in range(20):
            plant.step([torque])
            power.append(-plant.friction_torque[0] * plant.velocity(0))
    work = np.convolve(np.array(power) * plant.period, np.ones(WINDOW), "valid")
    return max(power), float(work.max())


def _curve_error(plant: Plant, velocity: float) -> float:
    law = plant.frictions[0].law
    plant.reset([-1.0 * np.sign(velocity)], [velocity])
    gain, feed_forward = 2.0 * plant.inertias[0] * 100.0, float(law.torque(velocity))
    for _ in range(1000):
        plant.step([feed_forward + gain * (velocity - plant.velocity(0))])
    return abs(plant.friction_torque[0] / float(law.torque(plant.velocity(0))) - 1.0)


def _speed(stand_in: StandIn) -> float:
    steps = 300
    stand_in.reset()
    stand_in.enable("velocity")
    begin = time.process_time()
    for k in range(steps):
        if k % 50 == 0:
            stand_in.command([0.0], [0.2], [0.0])
        stand_in.step()
    return steps * stand_in.settings.period / (time.process_time() - begin)
