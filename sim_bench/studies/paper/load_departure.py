"""Several normal loads: closed form, exported network and a data-driven one, between and beyond the loads measured."""

from dataclasses import dataclass

import numpy as np

from fricomp.calibration.identification import IdentificationResult, identify
from fricomp.laws import FloatArray, LoadScaling

from .departure import NOISE, HeldOutPoints, measure_networks, mirror
from .problem import PaperProblem

_REFERENCE = 10.0
_SLOWEST = 0.01
_LOADS = (5.0, 8.0, 11.0, 15.0, 20.0)
_BETWEEN = (6.5, 9.5, 13.0, 17.5)
_BEYOND = (24.0,)
LOAD_CASES = tuple((case, points) for case in ("Stribeck", "departs") for points in (40, 16))
"""Both joints, with many and with few points at each load."""


@dataclass(frozen=True)
class LoadFigures:
    """Root mean square torque error against the truth [N·m], mean over the seeds.

    Attributes:
        case: `Stribeck`, or `departs`: a hump of 0.15 N·m at 0.45 rad/s that grows with the load.
        points: Points at each of five loads.
        seeds: How many data sets.
        between: At loads between those measured: closed form, exported network, data-driven network.
        beyond: At 1.2 times the largest load measured, likewise.
        departed: On how many data sets the network was allowed to leave the closed form.
    """

    case: str
    points: int
    seeds: int
    between: list[float]
    beyond: list[float]
    departed: int


def measure_loads(case: str, points: int, seeds: int) -> LoadFigures:
    """One of `LOAD_CASES`."""
    size = float(case == "departs")
    velocity, load = _build_grid(np.geomspace(_SLOWEST, 1.0, points // 2), _LOADS)

    def identify_draw(seed: int) -> IdentificationResult:
        noise = NOISE * np.random.default_rng([seed, points, 3]).normal(size=len(velocity))
        torque = _collect_truth(velocity, load, size) + noise
        return identify(velocity, torque, load, "least_squares", "absolute", seed)

    held_out = [_build_grid(np.linspace(_SLOWEST, 1.0, 200), loads) for loads in (_BETWEEN, _BEYOND)]
    places = [HeldOutPoints(v, n, _collect_truth(v, n, size)) for v, n in held_out]
    (between, beyond), departed = measure_networks(identify_draw, seeds, places)
    return LoadFigures(case, points, seeds, between, beyond, departed)


def _build_grid(side: FloatArray, loads: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    velocity = mirror(side)
    return np.tile(velocity, len(loads)), np.repeat(np.array(loads), len(velocity))


def _collect_truth(velocity: FloatArray, load: FloatArray, size: float) -> FloatArray:
    law = PaperProblem().law_under(LoadScaling(1.0, _REFERENCE))
    hump = 0.15 * np.exp(-(((np.abs(velocity) - 0.45) / 0.12) ** 2)) * load / _REFERENCE
    return np.asarray(np.asarray(law.torque(velocity, normal_load=load)) + size * np.sign(velocity) * hump)
