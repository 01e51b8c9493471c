"""A torque without its sign: a current as a meter shows it, or as the size of a vector."""

from itertools import combinations

import numpy as np

from fricomp.recording.checks.joint_fit import BlockMotion, average_motion, build_design
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples
from fricomp.root_mean_square import compute_rms

_BELOW_ZERO = 0.01
"""Part of the largest torque by which noise may lead below zero."""
_ROUNDS = 10
"""Times that signs are taken from the joint that was fitted with the last ones."""
_LEAVES = 0.5
"""What a torque with its sign restored may leave unexplained, over what it leaves as it is."""
_TURNED = 0.05
"""Least part of the rows whose sign was lost."""


def find_lost_sign(recording: Recording) -> tuple[Finding, ...]:
    """A torque that never changes its sign, and is that of a joint once it does."""
    torque = np.asarray(recording.torque)
    size = float(np.max(np.abs(torque)))
    if np.ptp(torque) == 0.0 or min(float(np.max(torque)), -float(np.min(torque))) > _BELOW_ZERO * size:
        return ()
    motion = average_motion(recording)
    if motion is None or not _has_lost_sign(motion, np.abs(torque), rotary=recording.metadata.motion == "rotary"):
        return ()
    message = "torque never changes its sign, and is the torque of a joint where it does: it is a size without its sign"
    advice = "log the signed torque or current, such as the one of the torque axis (Iq), and not its size or its RMS"
    return (Finding("lost_sign", "error", message, advice, column="torque"),)


def _has_lost_sign(motion: BlockMotion, size: Samples, *, rotary: bool) -> bool:
    """Whether some signs make it the torque of a rigid joint far better than none.

    The joint that is fitted with some signs tells which they should have been, from each of many starts.
    """
    design, target = build_design(motion, rotary=rotary), motion.average(size)
    basis = np.linalg.qr(design)[0]
    plain, best = compute_rms(target - basis @ (basis.T @ target)), np.inf
    for start in _propose_signs(design):
        sign = start
        for _ in range(_ROUNDS):
            fitted = basis @ (basis.T @ (sign * target))
            sign = np.where(fitted >= 0.0, 1.0, -1.0)
        turned = min(float(np.mean(sign > 0.0)), float(np.mean(sign < 0.0)))
        best = min(best, compute_rms(sign * target - fitted)) if turned > _TURNED else best
    return best < _LEAVES * plain


def _propose_signs(design: Samples) -> list[Samples]:
    """Propose signs: those of each part of a joint's torque alone, and of each two of them. Shapes (n_rows,)."""
    parts = [column / np.max(np.abs(column)) for column in design.T if np.ptp(column) > 0.0]
    sums = [a + way * b for a, b in combinations(parts, 2) for way in (1.0, -1.0)]
    return [np.where(one >= 0.0, 1.0, -1.0) for one in (*parts, *sums)]
