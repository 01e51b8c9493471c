"""How well the rigid-body model explains the torque of fast motions: the age of the torque signal, and the scale."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

__all__ = ["RigidBodyFit", "fit_rigid_body"]

# Only what moves faster than this fraction of a block's top speed is looked at: no sticking, no falling branch.
FAST = 0.3
# Smoothing of the torque, as wide as that of the derivatives in the rigid-body torque [s].
SMOOTHING = 0.04
# The rigid-body torque must change by this many times the rest for a block to count [1].
STRONG = 0.2


@dataclass(frozen=True)
class RigidBodyFit:
    """What fast motions say about torque signal and model.

    Attributes:
        lag: Age of the torque beside the position [s].
        scale: Measured over modelled rigid-body torque [1].
        scale_deviation: Its standard error, from the scatter among the motions [1].
        motions: Number of motions that had a say.
    """

    lag: float = 0.0
    scale: float = 1.0
    scale_deviation: float = float("inf")
    motions: int = 0


def fit_rigid_body(blocks: Iterable[Recording]) -> RigidBodyFit:
    """Least squares of torque on the rigid-body torque R and its rate, friction a free level for each direction.

    A torque signal that is old by t_l reads R(t - t_l) = R - t_l R' to first order. The mean over a plateau does not
    cancel this: over a stretch on which gravity rises by dR in the time T it is t_l dR/T.
    """
    normal, right, scales = np.zeros((2, 2)), np.zeros(2), []
    for block in blocks:
        found = _reduce(block)
        if found is not None:
            columns, rest = found
            normal += columns.T @ columns
            right += columns.T @ rest
            scales.append(float(np.linalg.lstsq(columns, rest, rcond=None)[0][0]))
    if len(scales) < 2:
        return RigidBodyFit()
    scale, rate = np.linalg.solve(normal, right)
    deviation = float(np.std(scales, ddof=1) / np.sqrt(len(scales)))
    return RigidBodyFit(float(-rate), 1.0 + float(scale), deviation, len(scales))


def _reduce(block: Recording) -> tuple[FloatArray, FloatArray] | None:
    """R, R' and the rest of the torque with level, direction and speed taken out; None for a motion that is slow."""
    load, reference = block.load_torque, block.velocity_reference
    if load is None or reference is None or len(block) < 100:
        return None
    velocity = np.gradient(block.position, block.time)
    width = max(1, round(SMOOTHING / block.sample_period))
    kernel = np.hanning(width + 2)[1:-1]
    load, torque, velocity = (np.convolve(x, kernel / kernel.sum(), "same") for x in (load, block.torque, velocity))
    rate = np.gradient(load, block.time)
    used = np.abs(velocity) > FAST * np.max(np.abs(velocity))
    used[: 2 * width] = used[-2 * width :] = False
    if used.sum() < 100 or np.std(load[used]) < STRONG * np.std(torque[used]):
        return None
    nuisance = np.column_stack([np.ones(used.sum()), np.sign(velocity[used]), velocity[used]])
    basis, _ = np.linalg.qr(nuisance)
    both = np.column_stack([load, rate, torque - load])[used]
    both = both - basis @ (basis.T @ both)
    return both[:, :2], both[:, 2]
