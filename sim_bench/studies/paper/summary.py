"""Figures from the ledger of finished draws."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import t as student

from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from ..kit.store import RowStore
from .problem import PaperProblem, Reading

_REACH = float(student.ppf(0.975, 192))
"""Half width of a 95 % interval in standard deviations: 200 points, eight parameters."""


@dataclass(frozen=True)
class StatisticsFigures:
    """Our PINN over many draws of one noise reading; lists follow the paper's order of parameters.

    Attributes:
        draws: How many.
        converged: How many reported so.
        from_projection: In how many the training from the projection ended at the optimum, with no other start.
        rms_over_bound: Root mean square error over the Cramér-Rao bound.
        rms_error: Monte-Carlo standard error of each of these.
        coverage: Share of 95 % intervals that hold the true value.
        coverage_error: Monte-Carlo standard error of each.
        largest_distance: Largest distance of any parameter in any draw to the oracle's optimum [CRB deviations].
        typical_distance: Root mean square of that distance.
        largest_excess: Largest negative log-likelihood above the oracle's [nats].
        mean_error: Mean |error| over all parameters and draws [%].
        error_spread: Smallest and largest mean |error| of a single draw [%].
    """

    draws: int
    converged: int
    from_projection: int
    rms_over_bound: list[float]
    rms_error: float
    coverage: list[float]
    coverage_error: float
    largest_distance: float
    typical_distance: float
    largest_excess: float
    mean_error: float
    error_spread: tuple[float, float]


def summarise_statistics(ledger: RowStore, reading: Reading) -> StatisticsFigures | None:
    """None where there are no draws yet."""
    rows = ledger.rows(study="statistics", reading=reading)
    if not rows:
        return None
    problem = PaperProblem()
    bound, true = problem.cramer_rao(reading), np.array(problem.true_values)
    values, oracle, deviations = (_collect_column(rows, name) for name in ("values", "oracle", "deviations"))
    covered = np.abs(values - true) <= _REACH * deviations
    apart = np.abs(values - oracle) / bound
    percent = 100.0 * np.abs(values - true) / true
    n = len(rows)
    return StatisticsFigures(
        draws=n,
        converged=sum(row["status"] == "converged" for row in rows),
        from_projection=sum(row["start"] == "projection" for row in rows),
        rms_over_bound=(np.sqrt(np.mean((values - true) ** 2, axis=0)) / bound).tolist(),
        rms_error=float(1.0 / np.sqrt(2.0 * n)),
        coverage=np.mean(covered, axis=0).tolist(),
        coverage_error=float(np.sqrt(0.95 * 0.05 / n)),
        largest_distance=float(apart.max()),
        typical_distance=compute_rms(apart),
        largest_excess=float(max(row["nll"] - row["oracle_nll"] for row in rows)),
        mean_error=float(np.mean(percent)),
        error_spread=(float(percent.mean(axis=1).min()), float(percent.mean(axis=1).max())),
    )


def _collect_column(rows: list[dict[str, Any]], name: str) -> FloatArray:
    return np.array([row[name] for row in rows])


@dataclass(frozen=True)
class OutlierFigures:
    """Robust fits with a tenth of the points off by ten deviations.

    Attributes:
        draws: How many.
        flagged: How many did not report `converged`.
        rms_over_bound: Root mean square error over the bound of the clean points, all draws.
        rms_of_converged: The same over the draws that reported `converged`.
        coverage: Share of their 95 % intervals that hold the true value.
        wrong_basins: Draws with an error above five deviations.
        silent_wrong_basins: Those of them that reported `converged`.
    """

    draws: int
    flagged: int
    rms_over_bound: list[float]
    rms_of_converged: list[float]
    coverage: list[float]
    wrong_basins: int
    silent_wrong_basins: int


def summarise_outliers(ledger: RowStore, reading: Reading) -> OutlierFigures | None:
    """None where there are no draws yet."""
    rows = ledger.rows(study="outliers", reading=reading)
    if not rows:
        return None
    error = _collect_column(rows, "values") - np.array(PaperProblem().true_values)
    scaled, covered = (
        error / _collect_column(rows, "limit"),
        np.abs(error) <= _REACH * _collect_column(rows, "deviations"),
    )
    good = np.array([row["status"] == "converged" for row in rows])
    wrong = np.max(np.abs(scaled), axis=1) > 5.0
    return OutlierFigures(
        draws=len(rows),
        flagged=int(np.sum(~good)),
        rms_over_bound=np.sqrt(np.mean(scaled**2, axis=0)).tolist(),
        rms_of_converged=np.sqrt(np.mean(scaled[good] ** 2, axis=0)).tolist() if np.any(good) else [],
        coverage=np.mean(covered[good], axis=0).tolist() if np.any(good) else [],
        wrong_basins=int(np.sum(wrong)),
        silent_wrong_basins=int(np.sum(wrong & good)),
    )
