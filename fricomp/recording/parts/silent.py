"""Stretches in which the drive is off while the joint moves: somebody moves it, or a brake stops it."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.joint_fit import BlockMotion, average_motion, build_design
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples
from fricomp.root_mean_square import compute_rms

Rows = NDArray[np.bool_]

_SMOOTH = 0.2
"""Time over which a torque is averaged to be called next to nothing [s]: far longer than noise remembers."""
_SHORTEST = 2.0
"""Stretch below which a torque near zero may be that of a motion that slows down [s], as for torques of exactly 0."""
_NOTHING = 0.2
"""Torque over the usual one of the motion, up to which it is next to nothing."""
_NEEDED = 4.0
"""Torque that the joint needs there by all that is left, over the one that was recorded, from which on it was off."""
_KNOWN = 0.8
"""Part of the torque's variance that a rigid joint with friction must explain elsewhere to say so."""
_FEWEST = 60
"""Blocks that slide elsewhere, as many as a joint is fitted to at least, and in a stretch."""
_FEWEST_BRAKED = 1
"""Blocks that slide until a brake has stopped the joint: it takes a tenth of a second, and zeros follow for long."""
_AT_REST = 1e-3
"""Speed over the top one, below which a joint has stopped."""
_MATTERS = 0.3
"""Torque that is needed over the usual one, below which its lack may be what the rigid joint leaves elsewhere."""


def find_silent_rows(recording: Recording) -> Rows:
    """Rows of long stretches with next to no torque in which the joint moves as it needs one elsewhere.

    A joint of hardly any friction needs none, and its rows stay, and so do those of one that coasts: what tells is the
    joint that all other rows show. Shape (n_samples,).
    """
    rows = np.zeros(len(recording), dtype=bool)
    motion = average_motion(recording)
    if motion is None or recording.metadata.torque_kind == "commanded":
        return rows
    torque, rotary = motion.average_all(np.asarray(recording.torque)), recording.metadata.motion == "rotary"
    quiet, braked = _find_quiet(torque, motion), _find_braked(torque, motion)
    for found, fewest in ((quiet, _FEWEST), (braked, _FEWEST_BRAKED)):
        if found.any() and _needs_torque(torque, found, motion, fewest, rotary=rotary):
            rows[: found.size * motion.width] |= np.repeat(found, motion.width)
    return rows


def _list_stretches(rows: Rows) -> list[tuple[int, int]]:
    """Start and end, exclusive, of each stretch of blocks."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rows, [False]]).astype(int)))
    return [(int(start), int(stop)) for start, stop in zip(edges[::2], edges[1::2], strict=True)]


def _find_quiet(torque: Samples, motion: BlockMotion) -> Rows:
    """Blocks of the stretches with next to no torque."""
    count = max(1, round(_SMOOTH / float(np.median(np.diff(motion.time)))))
    smooth = np.abs(np.convolve(torque, np.ones(count) / count, "same"))
    low = smooth < _NOTHING * float(np.median(np.abs(torque[motion.rows])))
    for start, stop in _list_stretches(low):
        if motion.time[stop - 1] - motion.time[start] < _SHORTEST or not motion.rows[start:stop].any():
            low[start:stop] = False
    return low


def _find_braked(torque: Samples, motion: BlockMotion) -> Rows:
    """Blocks in which the joint still moves while the torque is exactly 0, and stays so for long: the drive is off."""
    zero: Rows = np.asarray(torque == 0.0)
    top = float(np.max(np.abs(motion.velocity)))
    for start, stop in _list_stretches(zero):
        if motion.time[stop - 1] - motion.time[start] < _SHORTEST:
            zero[start:stop] = False
        moving = np.flatnonzero(np.abs(motion.velocity[start:stop]) > _AT_REST * top)
        zero[start + (moving[-1] + 2 if moving.size else 0) : stop] = False  # the rest that follows is one
    return zero


def _needs_torque(torque: Samples, quiet: Rows, motion: BlockMotion, fewest: int, *, rotary: bool) -> bool:
    """Whether the joint that the other blocks show would need far more torque in the quiet ones."""
    inside, own = quiet[motion.rows], torque[motion.rows]
    if np.count_nonzero(inside) < fewest or np.count_nonzero(~inside) < _FEWEST:
        return False
    design = build_design(motion, rotary=rotary)
    solution = np.linalg.lstsq(design[~inside], own[~inside], rcond=None)[0]
    left = own[~inside] - design[~inside] @ solution
    known = float(np.var(left)) < (1.0 - _KNOWN) * float(np.var(own[~inside]))
    needed = compute_rms(design[inside] @ solution)
    return known and needed > max(_NEEDED * compute_rms(own[inside]), _MATTERS * compute_rms(own[~inside]))
