"""Speeds chosen for information: where to spend a sweep's time so that the parameters become known best.

Information adds up with the time spent at a speed, so the shares of time that minimise the mean relative standard
deviation are a convex problem; the multiplicative algorithm solves it [silvey1978algorithm].
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fricomp.errors import IdentificationError
from fricomp.laws import BidirectionalStribeck, FloatArray
from fricomp.model import FrictionModel

from .estimation.form import separable_law
from .estimation.information import compute_log_deviations, invert_information
from .estimation.observation import list_places

__all__ = ["SpeedPlan", "expected_deviation", "plan_informative_speeds"]

NoiseReading = Literal["relative", "absolute"]
_CANDIDATES = 160
_ITERATIONS = 2000
_NEGLIGIBLE = 0.02
"""Share of one direction's time below which a speed is merged into its neighbour."""


@dataclass(frozen=True)
class SpeedPlan:
    """Speeds and how much of the time to spend at each.

    Attributes:
        velocity: Signed plateau velocities [rad/s] or [m/s]. Shape (n_speeds,).
        share: Share of the plateau time at each; sums to 1. Shape (n_speeds,).
        plateaus: Share in whole plateaus of equal length; sums to the number asked for. Shape (n_speeds,).
        mean_deviation: Mean relative standard deviation of the parameters to expect from `plateaus`, one reading of
            unit noise level each: multiply by the noise level [1 a unit of noise].
        uniform_deviation: The same for as many plateaus spaced evenly up to the limit.
    """

    velocity: FloatArray
    share: FloatArray
    plateaus: np.ndarray[tuple[int], np.dtype[np.intp]]
    mean_deviation: float
    uniform_deviation: float

    @property
    def ratio(self) -> float:
        """Standard deviation to expect, as a fraction of the uniform grid's at the same number of plateaus."""
        return self.mean_deviation / self.uniform_deviation


def plan_informative_speeds(
    model: FrictionModel,
    speed_limit: float,
    n: int,
    noise: NoiseReading = "relative",
    *,
    slowest: float | None = None,
) -> SpeedPlan:
    """Choose plateau speeds from a coarse fit.

    Args:
        model: Coarse fit, a bidirectional Stribeck law.
        speed_limit: Highest speed allowed [rad/s] or [m/s].
        n: Plateaus of equal length to distribute over both directions.
        noise: Whether the noise of a plateau is relative to the torque or absolute.
        slowest: Lowest speed allowed [rad/s] or [m/s]; a hundredth of the limit by default.

    Raises:
        IdentificationError: The law is not a bidirectional Stribeck law, or there are fewer plateaus than parameters.
    """
    if not any(isinstance(term, BidirectionalStribeck) for term in model.law.terms):
        raise IdentificationError("a sweep is planned from a bidirectional Stribeck law; identify one first")
    low = speed_limit / 100.0 if slowest is None else slowest
    if n < 8 or not 0.0 < low < speed_limit:
        raise IdentificationError(
            f"at least 8 plateaus and a speed limit above the slowest speed are needed, got n={n}, "
            f"speeds {low:g} to {speed_limit:g}"
        )
    grid = np.geomspace(low, speed_limit, _CANDIDATES)
    velocity = np.concatenate([-grid[::-1], grid])
    regressors = _compute_regressors(model, velocity, noise)
    share = _merge(velocity, _minimise_deviation(regressors))
    plateaus = _share_out(share, n)
    used = plateaus > 0
    uniform = np.linspace(speed_limit / (n // 2), speed_limit, n // 2)
    return SpeedPlan(
        velocity[used],
        share[used] / share[used].sum(),
        plateaus[used],
        _compute_mean_deviation(regressors[used], plateaus[used].astype(np.float64)),
        expected_deviation(model, np.concatenate([-uniform, uniform]), noise),
    )


def expected_deviation(model: FrictionModel, velocity: FloatArray, noise: NoiseReading = "relative") -> float:
    """Mean relative standard deviation of the parameters from one reading at each velocity, per unit of noise level.

    Args:
        model: A bidirectional Stribeck law.
        velocity: [rad/s] or [m/s]. Shape (n,).
        noise: Whether the noise is relative to the torque or absolute.
    """
    moving = velocity[velocity != 0.0]
    return _compute_mean_deviation(_compute_regressors(model, moving, noise), np.ones(len(moving)))


def _compute_regressors(model: FrictionModel, velocity: FloatArray, noise: NoiseReading) -> FloatArray:
    """Derivative of a reading, in units of its noise, by the logarithms. Shape (n_speeds, n_parameters)."""
    form, values = separable_law("stribeck"), model.law.parameters()
    logs = np.log(np.maximum([values[name] for name in form.names], 1e-12))
    magnitude, jacobian = form.evaluate(logs, list_places(velocity))
    return jacobian / magnitude[:, None] if noise == "relative" else jacobian


def _compute_covariance(regressors: FloatArray, effort: FloatArray) -> FloatArray:
    return invert_information(_compute_information(regressors, effort))


def _compute_information(regressors: FloatArray, effort: FloatArray) -> FloatArray:
    return np.asarray((regressors * effort[:, None]).T @ regressors)


def _compute_mean_deviation(regressors: FloatArray, effort: FloatArray) -> float:
    return float(np.mean(compute_log_deviations(_compute_information(regressors, effort))))


def _minimise_deviation(regressors: FloatArray) -> FloatArray:
    """Shares of time that minimise the mean relative standard deviation. Shape (n_speeds,)."""
    share = np.full(len(regressors), 1.0 / len(regressors))
    for _ in range(_ITERATIONS):
        covariance = _compute_covariance(regressors, share)
        # Minus the derivative of sum_i sqrt(C_ii) by the share of a speed.
        gain = 0.5 * (regressors @ covariance) ** 2 @ (1.0 / np.sqrt(np.diag(covariance)))
        updated = share * np.sqrt(gain)
        updated /= updated.sum()
        if np.max(np.abs(updated - share)) < 1e-9:
            break
        share = updated
    return share


def _merge(velocity: FloatArray, share: FloatArray) -> FloatArray:
    """Collect each hill of neighbouring shares at its centre; the optimum has few speeds, the grid blurs them."""
    merged = np.zeros_like(share)
    for side in (velocity < 0.0, velocity > 0.0):
        index = np.flatnonzero(side)
        local = share[index]
        hills = np.flatnonzero(local > 1e-4)
        for group in np.split(hills, np.flatnonzero(np.diff(hills) > 1) + 1):
            centre = round(float(np.average(group, weights=local[group])))
            if local[group].sum() >= _NEGLIGIBLE * local.sum():
                merged[index[centre]] += local[group].sum()
    return np.asarray(merged / merged.sum())


def _share_out(share: FloatArray, n: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Whole plateaus that add up to n, by largest remainder; no chosen speed goes without."""
    wanted = share * n
    counts = np.where(share > 0.0, np.maximum(np.floor(wanted), 1.0), 0.0)
    while counts.sum() > n:
        counts[np.argmax(np.where(counts > 1.0, counts - wanted, -np.inf))] -= 1.0
    while counts.sum() < n:
        counts[np.argmax(np.where(share > 0.0, wanted - counts, -np.inf))] += 1.0
    return counts.astype(np.intp)
