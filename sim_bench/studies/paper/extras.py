"""Two more figures of the page: speeds chosen for information, and LuGre from a time series."""

from dataclasses import dataclass

import numpy as np

from fricomp.calibration.identification import Status, identify, identify_dynamic, plan_informative_speeds
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .bristle import BRISTLE, record_lugre
from .problem import PaperProblem

_LEVEL = 0.05
_PLATEAUS = 200
_REACH = 1.96
"""Standard deviations of a 95 % interval; the records have tens of thousands of samples."""
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
        lugre_damping_percent: Largest error of sigma_1 [%].
        lugre_coverage: Share of all 95 % intervals that hold the truth.
        lugre_converged: Records that report `converged`.
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
    lugre_damping_percent: float
    lugre_coverage: float
    lugre_converged: int


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
    errors, held, converged = _measure_lugre(lugre_seeds)
    return ExtraFigures(
        uniform_percent=100.0 * _LEVEL * plan.uniform_deviation,
        planned_percent=100.0 * _LEVEL * plan.mean_deviation,
        ratio=plan.ratio,
        top_share=float(plan.share[top].sum()),
        measured_ratio=_compute_mean_error(planned, draws) / _compute_mean_error(uniform, draws),
        lugre_seconds=_LUGRE_SECONDS,
        lugre_seeds=lugre_seeds,
        lugre_static_percent=float(errors[:8].max()),
        lugre_stiffness_percent=float(errors[8]),
        lugre_damping_percent=float(errors[9]),
        lugre_coverage=held,
        lugre_converged=converged,
    )


def _compute_mean_error(velocity: FloatArray, draws: int) -> float:
    """Mean over the parameters of the relative RMS error."""
    true, exact = np.array(PaperProblem().true_values), np.asarray(PaperProblem().law.torque(velocity))
    errors = []
    for seed in range(draws):
        torque = exact * (1.0 + _LEVEL * np.random.default_rng([seed, 7]).normal(size=len(velocity)))
        result = identify(velocity, torque, method="least_squares", noise="relative")
        errors.append(np.array(list(result.parameters.values())) / true - 1.0)
    return float(np.mean(np.sqrt(np.mean(np.square(errors), axis=0))))


def _measure_lugre(seeds: int) -> tuple[FloatArray, float, int]:
    """Largest error of each parameter [%], share of 95 % intervals that hold the truth, records that converged."""
    true = np.array([*PaperProblem().true_values, *BRISTLE])
    errors, held, converged = [], [], 0
    for seed in range(seeds):
        record = record_lugre(PaperProblem().true_values, _LUGRE_SECONDS, seed)
        found = identify_dynamic(record.time, record.velocity, record.torque)
        error = np.array(list(found.parameters.values())) - true
        errors.append(100.0 * np.abs(error / true))
        held.append(np.abs(error) < _REACH * np.sqrt(np.diag(found.covariance)))
        converged += found.status is Status.CONVERGED
    return np.max(errors, axis=0), float(np.mean(held)), converged
