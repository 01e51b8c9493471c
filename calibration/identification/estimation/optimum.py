"""The maximum-likelihood optimum of the closed form, every basin tried."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import leastsq

from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .form import SeparableLaw
from .likelihood import Noise, Whitened
from .observation import Observations
from .start import Scan, starting_points

__all__ = ["Optimum", "bounded", "fit_likelihood", "minimise_squares", "optimum_at", "refine"]

_LARGEST_LOG = 60.0
_EXACT = 1e-8
"""Residuals below this fraction of the largest torque come from rounding."""


@dataclass(frozen=True)
class Optimum:
    """A point in parameter space with what the likelihood says there.

    Attributes:
        logs: Logarithms of the parameters. Shape (n_parameters,).
        noise: Noise model it was evaluated under.
        whitened: Whitened residuals and their derivative by the logarithms.
        magnitude: Friction magnitude of the closed form [N·m] or [N]. Shape (n_points,).
        jacobian: Its derivative by the logarithms. Shape (n_points, n_parameters).
        negative_log_likelihood: The noise level at its optimum.
        other_basins: The same of every other basin that was refined, ascending.
    """

    logs: FloatArray
    noise: Noise
    whitened: Whitened
    magnitude: FloatArray
    jacobian: FloatArray
    negative_log_likelihood: float
    other_basins: tuple[float, ...] = ()

    def score_distance(self) -> float:
        """Distance to the likelihood's stationary point by its own gradient, in standard deviations.

        Zero at an optimum; 0.01 means that a Newton step would move the parameters by a hundredth of a
        standard deviation (Mahalanobis).
        """
        r, J = self.whitened.residual, self.whitened.jacobian
        step, *_ = np.linalg.lstsq(J, r, rcond=1e-12)
        spread = self.noise.variance(r, J.shape[1])
        return float(np.linalg.norm(J @ step) / np.sqrt(max(spread, 1e-300)))

    def spread(self) -> float:
        """Root mean square of the whitened residuals."""
        return compute_rms(self.whitened.residual)

    def is_exact(self) -> bool:
        """Whether the closed form meets the data to rounding, where likelihoods no longer compare."""
        return self.spread() <= _EXACT * float(np.max(self.magnitude * self.whitened.weight))


def optimum_at(logs: FloatArray, law: SeparableLaw, observations: Observations, noise: Noise) -> Optimum:
    """The likelihood at `logs`."""
    magnitude, jacobian = law.evaluate(logs, observations)
    whitened = noise.whiten(observations.magnitude, magnitude, jacobian)
    nll = noise.negative_log_likelihood(whitened.residual, observations.torque_scale)
    return Optimum(logs, noise, whitened, magnitude, jacobian, nll)


def fit_likelihood(law: SeparableLaw, observations: Observations, noise: Noise, scan: Scan | None = None) -> Optimum:
    """Maximise the likelihood from every basin of the projection, whose `scan` is not done again where it is known.

    Raises:
        IdentificationError: Too few points for the law.
    """
    starts = starting_points(law, observations, noise, robust=False, scan=scan)
    fits = sorted((refine(s, law, observations, noise) for s in starts), key=lambda fit: fit.negative_log_likelihood)
    return replace(fits[0], other_basins=tuple(fit.negative_log_likelihood for fit in fits[1:]))


def refine(
    start: FloatArray, law: SeparableLaw, observations: Observations, noise: Noise, evaluations: int = 400
) -> Optimum:
    """The local optimum that Levenberg-Marquardt reaches from `start`."""
    upper = law.upper_logs(observations)

    def whiten(logs: FloatArray) -> Residuals:
        magnitude, jacobian = law.evaluate(bounded(logs, upper), observations)
        # Beyond its bound a parameter changes nothing.
        white = noise.whiten(observations.magnitude, magnitude, jacobian * (logs <= upper))
        return white.residual, white.jacobian

    end = minimise_squares(whiten, start, xtol=1e-10, ftol=1e-13, gtol=1e-14, maxfev=evaluations)
    return optimum_at(bounded(end, upper), law, observations, noise)


Residuals = tuple[FloatArray, FloatArray]
"""Residuals and their derivative. Shapes (n,) and (n, n_parameters)."""


def minimise_squares(evaluate: Callable[[FloatArray], Residuals], start: FloatArray, **limits: float) -> FloatArray:
    """Where Levenberg and Marquardt's method ends from `start`, within these limits of `scipy.optimize.leastsq`.

    The solver asks for residuals and derivative one after the other, and gets both from one evaluation.
    """
    at, found = start, evaluate(start)

    def look(x: FloatArray) -> Residuals:
        nonlocal at, found
        if not np.array_equal(x, at):
            at, found = np.array(x), evaluate(x)
        return found

    with np.errstate(over="ignore", invalid="ignore"):  # of a covariance that it makes as well
        end, *_ = leastsq(lambda x: look(x)[0], start, Dfun=lambda x: look(x)[1], full_output=True, **limits)
    return np.asarray(end)


def bounded(logs: FloatArray, upper: FloatArray | None = None) -> FloatArray:
    """Keep the exponential finite, and below `upper` where given; no friction parameter lies beyond e^60."""
    clipped = np.clip(logs, -_LARGEST_LOG, _LARGEST_LOG)
    return clipped if upper is None else np.minimum(clipped, upper)
