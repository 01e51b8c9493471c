"""Where the joint is no Stribeck joint: closed form, exported network and a purely data-driven one, held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fricomp.calibration.identification import IdentificationResult, identify
from fricomp.calibration.identification.discrepancy import WEIGHTS, fit_discrepancy, train_towards
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .problem import PaperProblem

NOISE = 0.01
"""Standard deviation of the torque [N·m]."""


@dataclass(frozen=True)
class DepartureFigures:
    """Root mean square torque error against the truth [N·m], mean over the seeds.

    Attributes:
        case: `Stribeck`, or `departs`: a hump of 0.15 N·m at 0.45 rad/s and 0.1 |v|^3 on top.
        points: Points identified from.
        seeds: How many data sets.
        inside: Within the trained speeds, between the points: closed form, exported network, data-driven network.
        outside: The same from 1 to 1.4 times the fastest trained speed.
        departed: On how many data sets the network was allowed to leave the closed form.
    """

    case: str
    points: int
    seeds: int
    inside: list[float]
    outside: list[float]
    departed: int


CASES = tuple((case, points) for case in ("Stribeck", "departs") for points in (200, 60, 24))
"""Both joints, with many and with few points."""


class HeldOutPoints(NamedTuple):
    """Where models are held against the truth; arrays of one shape.

    Attributes:
        velocity: [rad/s]
        normal_load: [1]; None where the law has none.
        torque: True one [N·m].
    """

    velocity: FloatArray
    normal_load: FloatArray | None
    torque: FloatArray


def measure_departure(case: str, points: int, seeds: int) -> DepartureFigures:
    """One of `CASES`."""
    size, velocity = float(case == "departs"), mirror(np.linspace(2.0 / points, 1.0, points // 2))

    def identify_draw(seed: int) -> IdentificationResult:
        noise = NOISE * np.random.default_rng([seed, points]).normal(size=len(velocity))
        torque = _collect_truth(velocity, size) + noise
        return identify(velocity, torque, method="least_squares", noise="absolute", seed=seed)

    held_out = [mirror(np.linspace(2.0 / points, 1.0, 300)), mirror(np.linspace(1.0, 1.4, 100))]
    places = [HeldOutPoints(v, None, _collect_truth(v, size)) for v in held_out]
    (inside, outside), departed = measure_networks(identify_draw, seeds, places)
    return DepartureFigures(case, points, seeds, inside, outside, departed)


def _collect_truth(velocity: FloatArray, size: float) -> FloatArray:
    speed = np.abs(velocity)
    extra = 0.15 * np.exp(-(((speed - 0.45) / 0.12) ** 2)) + 0.1 * speed**3
    return np.asarray(np.asarray(PaperProblem().law.torque(velocity)) + size * np.sign(velocity) * extra)


def mirror(side: FloatArray) -> FloatArray:
    """Speeds in both directions. Shape (2 n,) for (n,)."""
    return np.concatenate([-side[::-1], side])


def measure_networks(
    identify_draw: Callable[[int], IdentificationResult], seeds: int, places: Sequence[HeldOutPoints]
) -> tuple[list[list[float]], int]:
    """Errors of closed form, of the network that may leave it, and of one held by the data alone.

    Args:
        identify_draw: Identifies the data set of a seed.
        seeds: How many.
        places: Where the errors are measured.

    Returns:
        RMS errors [N·m] of the three at each place, mean over the seeds; how often the network left the closed form.
    """
    errors, departed = [], 0
    for seed in range(seeds):
        result = identify_draw(seed)
        free, driven = fit_discrepancy(result, seed=seed), result.network
        for weight in WEIGHTS[1:]:
            driven = train_towards(driven, result, result.optimum, result.observations, weight)
        departed += free.departs
        models = (result.model, free.network, driven)
        errors.append([
            [compute_rms(np.asarray(one.torque(at.velocity, normal_load=at.normal_load)) - at.torque) for one in models]
            for at in places
        ])  # fmt: skip
    return np.mean(errors, axis=0).tolist(), departed
