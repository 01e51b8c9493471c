"""Whether an identification can be trusted."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .information import invert_information
from .observation import Observations
from .optimum import Optimum
from .result import Status

__all__ = [
    "BASIN_GAP",
    "CLOSE_ENOUGH",
    "RIVAL",
    "Verdict",
    "covariance_of",
    "find_vague",
    "judge",
    "nearest_rival",
    "vague_message",
]

BASIN_GAP = 0.01
"""Difference in negative log-likelihood beyond which another basin is better."""
CLOSE_ENOUGH = 0.05
"""Distance from the likelihood optimum, in standard deviations of each parameter, that counts as converged."""
RIVAL = 2.0
"""A basin less likely by no more than this [nats] cannot be told from the best."""
_UNKNOWN = 1.0
"""Relative standard deviation from which a positive parameter is not identified."""
_NEGLIGIBLE = 0.05
"""Share of the largest torque, at the fastest speed, within which a viscous coefficient may be unknown."""


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
    """Inverse Fisher information of the parameters. Shape (n_parameters, n_parameters).

    What the data say nothing about has a standard deviation of `information.UNDETERMINED` times its value.
    """
    information = found.noise.information(found.whitened, found.magnitude, found.jacobian)
    values = np.exp(found.logs)
    return np.asarray(invert_information(information) * np.outer(values, values))


def judge(
    found: Optimum, reference: Optimum, covariance: FloatArray, names: tuple[str, ...], points: Observations
) -> Verdict:
    """Compare what was found with the best basin of variable projection and least squares.

    What the data do not determine comes before convergence: along such a direction the likelihood is flat, and where
    training stopped on it says nothing.
    """
    deviation = np.sqrt(np.diag(covariance))
    values, best = np.exp(found.logs), np.exp(reference.logs)
    rounding = 1e-9 * best
    distance = float(np.max(np.abs(values - best) / (deviation + rounding)))
    gap = found.negative_log_likelihood - reference.negative_log_likelihood
    exact = found.spread() <= 1e-8 * float(np.max(found.magnitude * found.whitened.weight))
    vague = find_vague(dict(zip(names, zip(values, deviation, strict=True), strict=True)), points)
    rival = nearest_rival(reference)
    if not exact and gap > BASIN_GAP and distance > 1.0:
        return Verdict(
            Status.NOT_CONVERGED,  # not merely suspected: such a model is refused wherever one is used
            f"another basin is more likely by {gap:.3g} nats; do not use these parameters",
            distance,
        )
    if vague:
        return Verdict(Status.NOT_IDENTIFIABLE, vague_message(vague, points), distance)
    if not exact and distance > CLOSE_ENOUGH:
        return Verdict(
            Status.NOT_CONVERGED, f"training stopped {distance:.2g} standard deviations from the optimum", distance
        )
    if not exact and rival < RIVAL:
        return Verdict(
            Status.WRONG_BASIN_SUSPECTED, f"a second basin is less likely by only {rival:.2g} nats", distance
        )
    return Verdict(Status.CONVERGED, "converged to the likelihood optimum", distance)


def nearest_rival(optimum: Optimum) -> float:
    """How much less likely the next basin is than this one [nats]; infinity where there is none."""
    gaps = [other - optimum.negative_log_likelihood for other in optimum.other_basins]
    return min((gap for gap in gaps if gap > BASIN_GAP), default=np.inf)


_BELOW = ("static_torque", "stribeck_velocity", "smoothing_velocity")
"""Parameters that show at low speeds."""


def find_vague(found: dict[str, tuple[float, float]], points: Observations) -> list[str]:
    """Names of the parameters, of these values and standard deviations, that the data do not determine.

    A viscous coefficient near zero is known well enough where what it adds at the fastest speed is.
    """
    harmless = _NEGLIGIBLE * points.torque_scale / float(points.speed.max())
    return [
        name
        for name, (value, deviation) in found.items()
        if deviation > _UNKNOWN * value and not (name.endswith("viscous_coefficient") and deviation < harmless)
    ]


def vague_message(vague: list[str], points: Observations) -> str:
    """What is not determined, and which speeds would determine it."""
    low, high = float(points.speed.min()), float(points.speed.max())
    where = f"below {low:.3g}" if any(name.endswith(_BELOW) for name in vague) else f"outside {low:.3g} to {high:.3g}"
    return (
        f"the data do not determine {', '.join(vague)}: the standard deviation exceeds the value; add speeds {where}, "
        "where none was measured, or take a law without them"
    )
