"""What friction from a recorded motion is worth: its samples are correlated, and a rigid body was fitted beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.laws import FloatArray
from fricomp.model import Covariance

from ..identification import IdentificationResult, Status
from ..identification.verdict import RIVAL, find_vague, nearest_rival, vague_message

__all__ = ["weigh_rivals", "with_covariance", "with_offset_note"]


def with_covariance(result: IdentificationResult, covariance: FloatArray) -> IdentificationResult:
    """`result` with a covariance that knows of the rigid body and of correlated errors, and judged by it.

    What the data say nothing about has no slope, which looks certain to a linear fit, and correlation does not make
    samples worth more than independent ones: no variance is below that of independent samples.

    Args:
        result: The friction identified.
        covariance: Of its parameters. Shape (n_parameters, n_parameters).
    """
    short = np.maximum(np.diag(result.covariance) - np.diag(covariance), 0.0)
    covariance = covariance + np.diag(short)
    model = replace(result.model, covariance=Covariance(result.parameter_names, covariance))
    result = replace(result, model=model, covariance=covariance)
    deviations = np.sqrt(np.diag(covariance)).tolist()
    known = zip(result.parameters.items(), deviations, strict=True)
    vague = find_vague({name: (value, deviation) for (name, value), deviation in known}, result.observations)
    if result.status is not Status.CONVERGED or not vague:
        return result
    return _doubted(result, Status.NOT_IDENTIFIABLE, vague_message(vague, result.observations))


def weigh_rivals(result: IdentificationResult, found: IdentificationResult, samples: float) -> IdentificationResult:
    """`result`, in doubt where another basin is less likely by no more than independent samples could tell.

    Args:
        result: The friction identified.
        found: The same from every basin.
        samples: How many correlated samples are worth one, by the variances: the likelihood counts each of them.
    """
    rival = nearest_rival(found.optimum) / samples
    if result.status is not Status.CONVERGED or rival >= RIVAL:
        return result
    message = f"a second basin is less likely by only {rival:.2g} nats, correlated samples counted as one"
    return _doubted(result, Status.WRONG_BASIN_SUSPECTED, message)


def with_offset_note(result: IdentificationResult, offset: float) -> IdentificationResult:
    """With a sentence on where the torque offset went, for people and in the model file.

    Args:
        result: The friction identified.
        offset: Beside friction that is the same in both directions [N·m] or [N].
    """
    unit = result.model.torque_unit
    said = (
        "a constant torque offset cannot be told from friction that differs between the directions and counts as such; "
        f"with the same friction in both it would be {offset:.4g} {unit}"
    )
    provenance = result.model.provenance
    provenance = replace(provenance, notes={**provenance.notes, "torque_offset": f"0 assumed: {said}"})
    model = replace(result.model, provenance=provenance)
    return replace(result, model=model, message=f"{result.message}; {said}")


def _doubted(result: IdentificationResult, status: Status, message: str) -> IdentificationResult:
    provenance = replace(result.model.provenance, status=str(status), message=message)
    return replace(result, status=status, message=message, model=replace(result.model, provenance=provenance))
