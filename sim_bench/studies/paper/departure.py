"""Where the joint is no Stribeck joint: closed form, exported network and a purely data-driven one, held out."""

from dataclasses import dataclass

import numpy as np

from fricomp.calibration.identification import DiscrepancyNetwork, IdentificationResult, identify
from fricomp.calibration.identification.discrepancy import WEIGHTS, fit_discrepancy, train_towards
from fricomp.calibration.network import TanhNetwork
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .problem import PaperProblem

_NOISE = 0.01


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


def measure_departure(case: str, points: int, seeds: int) -> DepartureFigures:
    """One of `CASES`."""
    return _collect_figures(case, float(case == "departs"), points, seeds)


def _collect_truth(velocity: FloatArray, size: float) -> FloatArray:
    speed = np.abs(velocity)
    extra = 0.15 * np.exp(-(((speed - 0.45) / 0.12) ** 2)) + 0.1 * speed**3
    return np.asarray(np.asarray(PaperProblem().law.torque(velocity)) + size * np.sign(velocity) * extra)


def _collect_figures(case: str, size: float, points: int, seeds: int) -> DepartureFigures:
    inside, outside, departed = [], [], 0
    for seed in range(seeds):
        side = np.linspace(2.0 / points, 1.0, points // 2)
        velocity = np.concatenate([-side[::-1], side])
        torque = _collect_truth(velocity, size) + _NOISE * np.random.default_rng([seed, points]).normal(
            size=len(velocity)
        )
        result = identify(velocity, torque, method="least_squares", noise="absolute", seed=seed)
        free, driven = train_networks(result, seed)
        departed += free.departs
        models = (free.network, driven)
        inside.append(_collect_errors(result.model.torque, models, np.linspace(side[0], 1.0, 300), size))
        outside.append(_collect_errors(result.model.torque, models, np.linspace(1.0, 1.4, 100), size))
    a, b = np.mean(inside, axis=0).tolist(), np.mean(outside, axis=0).tolist()
    return DepartureFigures(case, points, seeds, a, b, departed)


def train_networks(result: IdentificationResult, seed: int) -> tuple[DiscrepancyNetwork, TanhNetwork]:
    """The network that may leave the closed form, and one held by the data alone."""
    driven = result.network
    for weight in WEIGHTS[1:]:
        driven = train_towards(driven, result, result.optimum, result.observations, weight)
    return fit_discrepancy(result, seed=seed), driven


def _collect_errors(
    closed: object, networks: tuple[TanhNetwork, TanhNetwork], side: FloatArray, size: float
) -> list[float]:
    velocity = np.concatenate([-side[::-1], side])
    exact = _collect_truth(velocity, size)
    functions = [closed, *(network.torque for network in networks)]
    return [compute_rms(np.asarray(f(velocity)) - exact) for f in functions]  # type: ignore[operator]
