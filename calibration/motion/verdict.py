"""What friction from a recorded motion is worth: its samples are correlated, and a rigid body was fitted beside it."""

from dataclasses import replace

from ..identification import IdentificationResult, Status
from ..identification.doubt import doubted
from ..identification.inference.verdict import RIVAL, nearest_rival
from .torque_lag import TorqueLag


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
    return doubted(result, Status.WRONG_BASIN_SUSPECTED, message)


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
    result = _with_note(result, "torque_offset", f"0 assumed: {said}")
    return replace(result, message=f"{result.message}; {said}")


def with_lag_note(result: IdentificationResult, lag: TorqueLag) -> IdentificationResult:
    """With the lag of the torque in the model file, and in doubt where it has not settled."""
    result = _with_note(result, "torque_age", f"{lag.value:.3g} +- {lag.deviation:.2g}")
    if lag.settled:
        return result
    apart = f"torque and motion come apart by some {1e3 * lag.value:.3g} ms, more than can be taken off"
    return doubted(result, Status.NOT_CONVERGED, f"{apart}: check the time stamps of both")


def _with_note(result: IdentificationResult, name: str, note: str) -> IdentificationResult:
    provenance = result.model.provenance
    provenance = replace(provenance, notes={**provenance.notes, name: note})
    return replace(result, model=replace(result.model, provenance=provenance))
