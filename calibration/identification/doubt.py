"""An identification in the light of what its own likelihood does not know: shared errors, correlated samples."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from fricomp.laws import FloatArray
from fricomp.model import Covariance
from fricomp.model.plausibility import find_impossible

from .estimation.information import with_least_variance
from .inference.verdict import find_vague, vague_message
from .result import IdentificationResult
from .status import Status


def with_covariance(result: IdentificationResult, covariance: FloatArray) -> IdentificationResult:
    """`result` with a covariance that knows more than the scatter of independent samples, and judged by it.

    What the data say nothing about has no slope, which looks certain to a linear fit, and correlation does not make
    samples worth more than independent ones: no variance is below that of independent samples.

    Args:
        result: The friction identified.
        covariance: Of its parameters. Shape (n_parameters, n_parameters).
    """
    covariance = with_least_variance(covariance, result.covariance)
    before = result.model.covariance or Covariance(result.parameter_names, covariance)
    model = replace(result.model, covariance=replace(before, matrix=covariance))
    result = replace(result, model=model, covariance=covariance)
    deviations = np.sqrt(np.diag(covariance)).tolist()
    known = zip(result.parameters.items(), deviations, strict=True)
    vague = find_vague({name: (value, deviation) for (name, value), deviation in known}, result.observations)
    if result.status in (Status.NOT_CONVERGED, Status.NOT_IDENTIFIABLE) or not vague:
        return result
    return doubted(result, Status.NOT_IDENTIFIABLE, vague_message(vague, result.observations))


def with_open_profiles(result: IdentificationResult) -> IdentificationResult:
    """`result`, in doubt where a parameter of the bend has an interval without an end.

    The likelihood of independent points closes an interval that correlated errors leave open: a bend below the slowest
    speeds shows by a few samples, which are off together.
    """
    if result.status in (Status.NOT_CONVERGED, Status.NOT_IDENTIFIABLE):
        return result
    ends = result.profiles.items()
    unknown = [name for name, interval in ends if interval.lower == 0.0 or not np.isfinite(interval.upper)]
    if not unknown:
        return result
    message = (
        f"the data do not determine {', '.join(unknown)}: with what correlated errors add, the likelihood leaves their "
        f"intervals open; add speeds below {float(result.observations.speed.min()):.3g}, or take a law without them"
    )
    return doubted(result, Status.NOT_IDENTIFIABLE, message)


def refuse_impossible(
    result: IdentificationResult, velocity: ArrayLike, inertia: tuple[float, float] | None = None
) -> IdentificationResult:
    """`result`, not identifiable where no joint can be like it; see `find_impossible` for the arguments."""
    reason = find_impossible(result.model, velocity, inertia)
    return result if reason is None else doubted(result, Status.NOT_IDENTIFIABLE, reason)


def doubted(result: IdentificationResult, status: Status, message: str) -> IdentificationResult:
    """`result` with another verdict, in its model file too."""
    provenance = replace(result.model.provenance, status=str(status), message=message)
    return replace(result, status=status, message=message, model=replace(result.model, provenance=provenance))
