"""Uncertainty where the covariance is not enough: intervals by profile likelihood, and block bootstrap."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import brentq
from scipy.stats import f as fisher

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from ..estimation.form import SeparableLaw
from ..estimation.observation import Observations
from ..estimation.optimum import Optimum, bounded, minimise_squares, refine
from .verdict import covariance_of

__all__ = ["BENT", "BootstrapSample", "Interval", "block_bootstrap", "profile_interval"]

BENT = ("coulomb_torque", "static_torque", "velocity", "exponent")
"""Ends of the names of parameters of a curve that bends, whose likelihood need not be quadratic."""
_FARTHEST = 8.0
"""Search an interval's ends up to this many standard deviations of the logarithm."""


@dataclass(frozen=True)
class Interval:
    """A confidence interval, in the unit of its parameter."""

    lower: float
    upper: float

    def holds(self, value: float) -> bool:
        """Whether `value` lies within it."""
        return self.lower <= value <= self.upper


class Identified(Protocol):
    """What these functions read of an identification; see `IdentificationResult`."""

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Dotted names, in the order of the covariance."""

    @property
    def parameters(self) -> dict[str, float]:
        """Estimates, each in its own unit."""

    @property
    def standard_deviations(self) -> dict[str, float]:
        """Of each parameter, in its own unit."""

    @property
    def covariance(self) -> FloatArray:
        """Shape (n_parameters, n_parameters)."""

    @property
    def freedom(self) -> int:
        """Degrees of freedom that its size is known from."""

    @property
    def observations(self) -> Observations:
        """The points used."""

    @property
    def rows(self) -> Observations:
        """Rows that stand for them."""

    @property
    def form(self) -> SeparableLaw:
        """The law's separable form."""

    @property
    def optimum(self) -> Optimum:
        """The likelihood at the parameters, from the rows."""

    @property
    def at_points(self) -> Optimum:
        """The same from the points."""


@dataclass(frozen=True)
class BootstrapSample:
    """Refits to resampled data.

    Attributes:
        names: Parameter names.
        parameters: Shape (n_samples, n_parameters).
    """

    names: tuple[str, ...]
    parameters: FloatArray

    def standard_deviations(self) -> dict[str, float]:
        """Of each parameter, in its own unit."""
        return dict(zip(self.names, self.parameters.std(axis=0, ddof=1).tolist(), strict=True))

    def interval(self, name: str, level: float = 0.95) -> Interval:
        """Between the quantiles of the sample."""
        column = self.parameters[:, self.names.index(name)]
        lower, upper = np.quantile(column, [0.5 - level / 2.0, 0.5 + level / 2.0])
        return Interval(float(lower), float(upper))


def profile_interval(result: Identified, name: str, level: float = 0.95) -> Interval:
    """Where the profile rises as far as the interval from the covariance would let it, were it quadratic.

    That is by half the quantile of F with the freedom the points leave [seber2003nonlinear], times what correlated or
    shared errors add to the variance. It need not be symmetric. An end that the data do not bound is 0 or infinite.

    Raises:
        IdentificationError: The law has no such parameter.
    """
    index = _find_index(result, name)
    freedom = result.freedom
    alone = max(float(covariance_of(result.optimum)[index, index]), 1e-300)
    rise = 0.5 * float(fisher.ppf(level, 1, freedom)) * max(1.0, float(result.covariance[index, index]) / alone)
    if result.optimum.noise.deviation is None:  # the level of the noise, at its optimum, grows with the misfit
        rise = 0.5 * result.rows.total * float(np.log1p(2.0 * rise / freedom))
    centre = float(result.optimum.logs[index])
    step = min(result.standard_deviations[name] / result.parameters[name], 1.0)

    def excess(log_value: float) -> float:
        return _compute_held(result, index, log_value) - rise

    ends = []
    for side in (-1.0, 1.0):
        outer = centre + side * step * np.array([2.0, 4.0, _FARTHEST])
        beyond = next((float(x) for x in outer if excess(float(x)) > 0.0), None)
        ends.append(side * np.inf if beyond is None else brentq(excess, *sorted((centre, beyond)), xtol=1e-4 * step))
    return Interval(float(np.exp(ends[0])), float(np.exp(ends[1])))


def _find_index(result: Identified, name: str) -> int:
    if name not in result.parameter_names:
        raise IdentificationError(f"unknown parameter {name!r}; estimated: {', '.join(result.parameter_names)}")
    return result.parameter_names.index(name)


def _compute_held(result: Identified, index: int, log_value: float) -> float:
    """Negative log-likelihood above the optimum with one logarithm held."""
    form, points, noise = result.form, result.rows, result.optimum.noise
    free = np.arange(len(form.names)) != index
    logs = result.optimum.logs.copy()
    logs[index] = log_value

    def whitened(some: FloatArray) -> tuple[FloatArray, FloatArray]:
        logs[free] = some
        magnitude, jacobian = form.evaluate(bounded(logs), points)
        white = noise.whiten(points.magnitude, magnitude, jacobian)
        return white.residual, white.jacobian[:, free]

    end = minimise_squares(whitened, logs[free], xtol=1e-9, ftol=1e-8, gtol=1e-8)
    held = noise.negative_log_likelihood(whitened(end)[0], points.torque_scale)
    best = noise.negative_log_likelihood(result.optimum.whitened.residual, points.torque_scale)
    return held - best


def block_bootstrap(result: Identified, block_length: int, samples: int = 200, seed: int = 0) -> BootstrapSample:
    """Refit to residuals resampled in blocks, which keeps their correlation within a block [kunsch1989bootstrap].

    Args:
        result: An identification of points in the order they were recorded.
        block_length: Points a block; longer than the correlation of the residuals.
        samples: Refits.
        seed: Seed of the resampling.

    Raises:
        IdentificationError: Blocks longer than half the data.
    """
    points, at = result.observations, result.at_points
    n, noise = points.size, at.noise
    if not 1 <= block_length <= n // 2:
        raise IdentificationError(f"block_length must lie between 1 and half of the {n} points, got {block_length}")
    rng = np.random.default_rng(seed)
    weight = at.whitened.weight
    residual = weight * (points.magnitude - at.magnitude)
    residual = (residual - residual.mean()) * np.sqrt(n / max(n - len(result.parameter_names), 1))
    refits = []
    for _ in range(samples):
        begin = rng.integers(0, n - block_length + 1, -(-n // block_length))
        index = (begin[:, None] + np.arange(block_length)).ravel()[:n]
        data = points.with_magnitude(at.magnitude + residual[index] / weight)
        refits.append(np.exp(refine(at.logs, result.form, data, noise).logs))
    return BootstrapSample(result.parameter_names, np.array(refits))
