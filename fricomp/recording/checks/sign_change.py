"""A torque whose sign turns within the recording: a driver that was set up anew, or two logs in one file."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.joint_fit import BlockMotion, average_motion, build_design, fit_motion
from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples
from fricomp.root_mean_square import compute_rms

_LEAVES = 0.5
"""What a torque with turns of its sign may leave unexplained, over what it leaves with fewer of them."""
_FEWEST = 20
"""Blocks of sliding between two turns of the sign."""
_GRID = 100
"""Rows at which two turns of the sign are tried before each is placed."""


def find_sign_change(recording: Recording) -> tuple[Finding, ...]:
    """A torque that is a joint's only where its sign turns at one time, or at a few: friction turns with it."""
    motion, torque = average_motion(recording), np.asarray(recording.torque)
    if motion is None or not torque.any():
        return ()
    turns = _locate_turns(motion, torque, rotary=recording.metadata.motion == "rotary")
    times = motion.time[motion.rows][turns]
    edges = [-np.inf, *times.tolist(), np.inf]
    spans = [(motion.time >= start) & (motion.time < end) for start, end in pairwise(edges)]
    if not turns or not _has_turning_friction(recording, motion, torque, spans):
        return ()
    at, first, last = ", ".join(f"{time:.3f}" for time in times), times[0], times[-1]
    message = (
        f"torque turns its sign at {at} s: friction brakes the motion on one side of it and drives it on the other"
    )
    advice = (
        f"take what has one sign (--to {first:.3f} or --from {last:.3f}; where that is refused as flipped, with sign = "
        "-1 in a mapping), or turn the other rows first"
    )
    return (Finding("sign_change", "error", message, advice, column="torque"),)


def _has_turning_friction(
    recording: Recording, motion: BlockMotion, torque: Samples, spans: list[NDArray[np.bool_]]
) -> bool:
    """Whether each stretch alone shows friction of the other sign than the one before: gravity of a neighbour that
    moves meanwhile may turn, friction does not."""
    fits = [fit_motion(motion._replace(rows=motion.rows & span), recording, torque, 0.0) for span in spans]
    friction = [0.0 if fit is None else fit.friction for fit in fits]
    return all(one * other < 0.0 for one, other in pairwise(friction))


def _locate_turns(motion: BlockMotion, torque: Samples, *, rotary: bool) -> list[int]:
    """Rows of the fit at which the torque turns its sign, in order; none where one sign throughout is as good.

    Turns once where that leaves no more than twice what turning there and back does.
    """
    basis = np.linalg.qr(build_design(motion, rotary=rotary))[0]
    target = motion.average(torque)
    if target.size <= 3 * _FEWEST:
        return []
    back = _place_pair(basis, target)
    back = _place_turn(basis, target, back[1:])  # from the grid to the row, one after the other
    back = _place_turn(basis, target, back[:1])
    tried: tuple[list[int], ...] = ([], _place_turn(basis, target, []), back)
    signed = [_turn(target, turns) for turns in tried]
    left = [compute_rms(one - basis @ (basis.T @ one)) for one in signed]
    if min(left) > _LEAVES * left[0]:
        return []
    turns, now = next((turns, now) for turns, now in zip(tried, left, strict=True) if min(left) >= _LEAVES * now)
    return turns if now < _measure_left_beside_pushes(basis, target, turns) else []


def _measure_left_beside_pushes(basis: Samples, target: Samples, turns: list[int]) -> float:
    """What the torque leaves where it has one sign, and another constant torque acts between these rows: a push that
    moves the joint looks like friction that drives."""
    part = np.searchsorted(turns, np.arange(target.size), side="right")
    pushed = np.linalg.qr(np.column_stack([basis, np.eye(len(turns) + 1)[part]]))[0]
    return compute_rms(target - pushed @ (pushed.T @ target))


def _place_pair(basis: Samples, target: Samples) -> list[int]:
    """Two rows of a coarse grid between which a turned sign explains most."""
    sums = np.cumsum(basis * target[:, None], axis=0)
    rows = np.linspace(_FEWEST, target.size - _FEWEST, _GRID).astype(np.intp)
    within = sums[rows][None, :, :] - sums[rows][:, None, :]
    explained = np.sum((sums[-1] - 2.0 * within) ** 2, axis=2)
    explained[rows[None, :] - rows[:, None] < _FEWEST] = -np.inf
    first, last = np.unravel_index(int(np.argmax(explained)), explained.shape)
    return [int(rows[first]) + 1, int(rows[last]) + 1]


def _place_turn(basis: Samples, target: Samples, turns: list[int]) -> list[int]:
    """One turn more, at the row where it explains most.

    With the sign turned from row k on, the basis explains |2 P_k - P_n|² of the torque, where P_k sums basis times
    torque before row k: all rows are tried in one pass.
    """
    sums = np.cumsum(basis * _turn(target, turns)[:, None], axis=0)
    explained = np.sum((2.0 * sums - sums[-1]) ** 2, axis=1)
    for edge in (0, *turns, target.size):
        explained[max(edge - _FEWEST, 0) : edge + _FEWEST] = -np.inf
    return sorted([*turns, int(np.argmax(explained)) + 1])


def _turn(target: Samples, turns: list[int]) -> Samples:
    """The torque with its sign turned at each of these rows. Shape (n_rows,)."""
    return np.where(np.searchsorted(turns, np.arange(target.size), side="right") % 2 == 0, target, -target)
