"""Whether an identification can be trusted."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .optimum import Optimum
from .result import Status

__all__ = ["BASIN_GAP", "Verdict", "covariance_of", "judge"]

BASIN_GAP = 0.01
"""Difference in negative log-likelihood beyond which another basin is better."""
_CLOSE_ENOUGH = 0.05
"""Distance from the likelihood optimum, in standard deviations of each parameter, that counts as converged."""
_RIVAL = 2.0
"""A basin less likely by no more than this [nats] cannot be told from the best."""
_UNKNOWN = 1.0
"""Relative standard deviation from which a positive parameter is not identified."""


class Verdict(NamedTuple):
    """The status of an identification.

    Attributes:
        status: In a word.
        message: In a sentence.
        distance: Largest distance of a parameter from the likelihood optimum, in standard deviations.
    """

    status: Status
    message: str
    distance: float


def covariance_of(found: Optimum) -> FloatArray:
    """Inverse Fisher information of the parameters. Shape (n_parameters, n_parameters)."""
    information = found.noise.information(found.whitened, found.magnitude, found.jacobian)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    inverse = np.linalg.pinv(information * np.outer(scale, scale), rcond=1e-14, hermitian=True)
    values = np.exp(found.logs)
    covariance = inverse * np.outer(scale * values, scale * values)
    return np.asarray(0.5 * (covariance + covariance.T))


def judge(
    found: Optimum, reference: Optimum, covariance: FloatArray, names: tuple[str, ...], *, converged: bool
) -> Verdict:
    """Compare what was found with the best basin of variable projection and least squares."""
    deviation = np.sqrt(np.diag(covariance))
    values, best = np.exp(found.logs), np.exp(reference.logs)
    rounding = 1e-9 * best
    distance = float(np.max(np.abs(values - best) / (deviation + rounding)))
    gap = found.negative_log_likelihood - reference.negative_log_likelihood
    exact = found.spread() <= 1e-8 * float(np.max(found.magnitude * found.whitened.weight))
    vague = [n for n, d, v in zip(names, deviation, values, strict=True) if d > _UNKNOWN * v]
    gaps = [nll - reference.negative_log_likelihood for nll in reference.other_basins]
    rival = min((other for other in gaps if other > BASIN_GAP), default=np.inf)
    if not exact and gap > BASIN_GAP and distance > 1.0:
        return Verdict(
            Status.WRONG_BASIN_SUSPECTED,
            f"another basin is more likely by {gap:.3g} nats; do not use these parameters",
            distance,
        )
    if not exact and (not converged or distance > _CLOSE_ENOUGH):
        return Verdict(
            Status.NOT_CONVERGED, f"training stopped {distance:.2g} standard deviations from the optimum", distance
        )
    if vague:
        return Verdict(
            Status.NOT_IDENTIFIABLE,
            f"the data do not determine {', '.join(vague)}: the standard deviation exceeds the value",
            distance,
        )
    if not exact and rival < _RIVAL:
        return Verdict(
            Status.WRONG_BASIN_SUSPECTED, f"a second basin is less likely by only {rival:.2g} nats", distance
        )
    return Verdict(Status.CONVERGED, "converged to the likelihood optimum", distance)
