"""Two more figures of the page: speeds chosen for information, and LuGre from a time series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from ..identification import identify, plan_informative_speeds
from ..identification.dynamic import simulate_bristle
from .problem import PaperProblem

__all__ = ["ExtraFigures", "measure_extras"]

_LEVEL = 0.05
_PLATEAUS = 200
_DT = 1e-3
_BRISTLE = (200.0, 0.5)
"""sigma_0 [N·m/rad] and sigma_1 [N·m·s/rad] of the simulated joint."""
_LUGRE_SECONDS = 40.0
"""Length of each of its records [s]."""


@dataclass(frozen=True)
class ExtraFigures:
    """Both figures.

    Attributes:
        uniform_percent: Mean standard deviation on the uniform grid [%].
        planned_percent: The same at the planned speeds [%].
        ratio: Of the two.
        top_share: Share of the effort at top speed.
        measured_ratio: Ratio of mean RMS errors on simulated plateaus.
        lugre_seconds: Length of a record [s].
        lugre_seeds: Records.
        lugre_static_percent: Largest error of a static parameter [%].
        lugre_stiffness_percent: Largest error of sigma_0 [%].
    """

    uniform_percent: float
    planned_percent: float
    ratio: float
    top_share: float
    measured_ratio: float
    lugre_seconds: float
    lugre_seeds: int
    lugre_static_percent: float
    lugre_stiffness_percent: float


def measure_extras(draws: int, lugre_seeds: int) -> ExtraFigures:
    """Measure both.

    Args:
        draws: Simulated sweeps a design.
        lugre_seeds: Noise seeds.
    """
    plan = plan_informative_speeds(FrictionModel(PaperProblem().law), 1.0, _PLATEAUS)
    top = np.abs(plan.velocity) > 0.99
    side = np.linspace(0.01, 1.0, _PLATEAUS // 2)
    uniform = np.concatenate([-side[::-1], side])
    planned = np.repeat(plan.velocity, plan.plateaus)
    static, stiffness = _lugre(lugre_seeds)
    return ExtraFigures(
        uniform_percent=100.0 * _LEVEL * plan.uniform_deviation,
        planned_percent=100.0 * _LEVEL * plan.mean_deviation,
        ratio=plan.ratio,
        top_share=float(plan.share[top].sum()),
        measured_ratio=_mean_error(planned, draws) / _mean_error(uniform, draws),
        lugre_seconds=_LUGRE_SECONDS,
        lugre_seeds=lugre_seeds,
        lugre_static_percent=static,
        lugre_stiffness_percent=stiffness,
    )


def _mean_error(velocity: FloatArray, draws: int) -> float:
    """Mean over the parameters of the relative RMS error."""
    true, exact = np.array(PaperProblem().true_values), np.asarray(PaperProblem().law.torque(velocity))
    errors = []
    for seed in range(draws):
        torque = exact * (1.0 + _LEVEL * np.random.default_rng([seed, 7]).normal(size=len(velocity)))
        result = identify(velocity, torque, method="least_squares", noise="relative")
        errors.append(np.array(list(result.parameters.values())) / true - 1.0)
    return float(np.mean(np.sqrt(np.mean(np.square(errors), axis=0))))


def _lugre(seeds: int) -> tuple[float, float]:
    """Largest error of a static parameter and of sigma_0 [%]."""
    t = np.arange(0.0, _LUGRE_SECONDS, _DT)
    velocity = 0.6 * np.sin(2.0 * np.pi * 0.3 * t) * np.sin(2.0 * np.pi * 0.05 * t + 0.3)
    velocity = velocity + 0.02 * np.sin(2.0 * np.pi * 1.1 * t)
    values = np.array([*PaperProblem().true_values, *_BRISTLE])
    exact = simulate_bristle(values[None], velocity, _DT)[:, 0]
    static, stiffness = 0.0, 0.0
    for seed in range(seeds):
        torque = exact * (1.0 + 0.02 * np.random.default_rng(seed).normal(size=len(t)))
        found = identify(velocity, torque, law="lugre", time=t)
        error = 100.0 * np.abs(np.array(list(found.parameters.values())) / values - 1.0)
        static, stiffness = max(static, float(error[:8].max())), max(stiffness, float(error[8]))
    return static, stiffness
