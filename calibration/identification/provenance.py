"""What a model file says of its identification: the data, how it ended, and what limits the model's use."""

import hashlib
from datetime import UTC, datetime

import numpy as np

from fricomp.model import Provenance
from fricomp.version import __version__

from .estimation.observation import Observations
from .inference.verdict import Verdict
from .result import NoiseEstimate


def compute_provenance(
    points: Observations,
    noise: NoiseEstimate,
    verdict: Verdict,
    largest_fitted: float,
    *,
    method: str,
    seed: int | None = None,
) -> Provenance:
    """Provenance of a model that was identified from friction points.

    Args:
        points: The data.
        noise: As estimated.
        verdict: How the identification ended.
        largest_fitted: Largest friction of the model at the points [N·m] or [N].
        method: How it was identified, such as `pinn`.
        seed: Of the identification.
    """
    return Provenance(
        method=method,
        data_sha256=_hash_points(points),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        fricomp_version=__version__,
        seed=seed,
        notes={"noise": noise.kind, "noise_level": f"{noise.level:.6g}", "points": str(points.size)},
        status=str(verdict.status),
        message=verdict.message,
        # The lower of both, so that neither an outlier nor a curve that misses its points counts.
        largest_torque=min(points.torque_scale, largest_fitted),
        slowest_speeds=_find_slowest(points),
    )


def _hash_points(points: Observations) -> str:
    digest = hashlib.sha256()
    for array in (points.velocity, points.magnitude, points.normal_load):
        if array is not None:
            digest.update(np.ascontiguousarray(array, dtype="<f8").tobytes())
    return digest.hexdigest()


def _find_slowest(points: Observations) -> tuple[float, float]:
    """Slowest speeds in reverse and forward; a direction without points has the other's, whose curve it shares."""
    reverse, forward = points.speed[~points.forward], points.speed[points.forward]
    return (
        float(np.min(reverse if len(reverse) else forward)),
        float(np.min(forward if len(forward) else reverse)),
    )
