"""A torque without its sign: a current as a meter shows it, or as the size of a vector; or with its sign in a bit."""

from itertools import combinations

import numpy as np

from fricomp.recording.checks.joint_fit import BlockMotion, average_motion, build_design, fit_joint
from fricomp.recording.checks.quantum import measure_quantum
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
_SIGN_BITS = (7, 9, 10, 11, 12, 14, 15)
"""Bits, counted from 0, in which registers have a sign: the last of a byte or two, and those above the sizes."""
_TURNED = 0.05
"""Least part of the rows whose sign was lost."""


def find_lost_sign(recording: Recording) -> tuple[Finding, ...]:
    """A torque that never changes its sign, and is that of a joint once it does."""
    torque = np.asarray(recording.torque)
    size = float(np.max(np.abs(torque)))
    if np.ptp(torque) == 0.0 or min(float(np.max(torque)), -float(np.min(torque))) > _BELOW_ZERO * size:
        return ()
    bit = _find_sign_bit(recording)
    if bit is not None:
        message = f"torque is stored as a size, with its sign in bit {bit} of its register, and was read as one number"
        advice = (
            f"write sign_bit = {bit} into the channel of a mapping where its column holds the counts ('fricomp convert "
            "LOG --inspect' has a mapping to edit); a velocity of the same device may need one as well"
        )
        return (Finding("sign_bit", "error", message, advice, column="torque"),)
    motion = average_motion(recording)
    if motion is None or not _has_lost_sign(motion, np.abs(torque), rotary=recording.metadata.motion == "rotary"):
        return ()
    message = "torque never changes its sign, and is the torque of a joint where it does: it is a size without its sign"
    advice = "log the signed torque or current, such as the one of the torque axis (Iq), and not its size or its RMS"
    return (Finding("lost_sign", "error", message, advice, column="torque"),)


def _find_sign_bit(recording: Recording) -> int | None:
    """The bit of a torque's register with its sign, where it is a joint's once it is read so; None where none is."""
    torque = np.asarray(recording.torque)
    quantum = measure_quantum(torque, most_levels=1.0)
    if quantum <= 0.0 or float(np.min(torque)) < 0.0:
        return None
    as_it_is = fit_joint(recording)
    for bit in _SIGN_BITS:
        above = torque >= quantum * (2.0**bit - 0.5)
        if not _TURNED < np.mean(above) < 1.0 - _TURNED or np.max(torque) >= quantum * 2.0 ** (bit + 1):
            continue
        read = fit_joint(recording, np.where(above, quantum * 2.0**bit - torque, torque))
        if read is not None and read.can_be and (as_it_is is None or read.residual < _LEAVES * as_it_is.residual):
            return bit
    return None


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
