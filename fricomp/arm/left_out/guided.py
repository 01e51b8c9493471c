"""Stretches of a recording in which something else than the drives moved or held the arm.

A hand that guides the arm for a while, a contact, or a load that is picked up: the torques of most joints then leave
what they rub with unexplained at the same time. Links and friction fitted to all of it would be of neither; so they
are fitted to the half of the stretches that agree best with each other [maronna2019robust], and those that do not go
with them are told and left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

from ..arm_recording import ArmRecording
from ..coordinates import ArmModel
from ..equations import ArmEquations, build_equations
from ..fit import ArmFit, fit_arm
from ..prior import ArmPrior
from ..rigid.simulated_arm import SimulatedArm
from ..row_weights import BoolArray
from ..rows import build_rows

__all__ = ["find_guided", "leave_out_spans"]

Spans = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class GuidedSettings:
    """When a stretch is taken to be none of the arm's own.

    Attributes:
        cutoff: Of the comparison [Hz]: a hand is slow, and what rings is none of it.
        stretch: [s] of a stretch, at both ends of which half of one is left out as well.
        fewest: Stretches from which half of them say what an arm is like.
        rows: Rows in which a joint moves from which on it counts in a stretch.
        rubs: Part of a joint's Coulomb torque that must be left of it. A hand takes or adds all of it; where nothing is
            wrong, a tenth is left at most, and where much is missing in the simulation a third.
        least: Part of a joint's torque that its Coulomb torque counts for at least: sensors behind gears show none.
        louder: The same over what the other stretches leave.
        share: Part of the joints that move of which that much must be left. A hand on an arm is felt by nearly all; a
            gear that gives way, or a load, by those before it.
        row: Stretches in a row from which on it is none of the arm's own: physics that is missing comes and goes with
            the motion, from stroke to stroke.
        rounds: Most rounds of choosing the half of the stretches.
    """

    cutoff: float = 2.5
    stretch: float = 2.0
    fewest: int = 8
    rows: int = 3
    rubs: float = 0.5
    least: float = 0.05
    louder: float = 3.0
    share: float = 0.75
    row: int = 3
    rounds: int = 6


GUIDED = GuidedSettings()


def find_guided(arm: SimulatedArm, recording: ArmRecording, settings: GuidedSettings = GUIDED) -> Spans:
    """Find the times in which more is left of nearly all joints than their friction allows for [s].

    Args:
        arm: The simulation, with the joints of the recording in its order.
        recording: All joints.
        settings: When a stretch counts as such.
    """
    rows = build_rows(arm, recording, settings.cutoff)
    if not len(rows):
        return ()
    equations = build_equations(arm, rows, rows.links @ arm.inertia.ravel(), plain=True)
    start, half = float(recording.parts[0].time[0]), 0.5 * settings.stretch
    number = np.floor((rows.time - start) / settings.stretch).astype(np.intp)
    stretches, number = np.unique(number, return_inverse=True)
    if len(stretches) < settings.fewest:
        return ()
    fit, left, usual = _fit_half(arm, equations, number, settings)
    torque = np.sqrt(np.mean(rows.torque**2, axis=0))
    level = np.maximum([fit.friction(j)["coulomb"] for j in range(len(arm.joints))], settings.least * torque)
    foreign = (left > settings.rubs * level) & (left > settings.louder * usual)
    moving = np.sum(np.isfinite(left), axis=1)
    guided = _keep_rows((np.sum(foreign, axis=1) >= settings.share * moving) & (moving > 1), settings.row)
    spans = [
        (start + settings.stretch * k - half, start + settings.stretch * (k + 1) + half)
        for k in stretches[guided].tolist()
    ]
    return _join(spans)


def leave_out_spans(recordings: Sequence[Recording], spans: Spans) -> list[Recording]:
    """The recordings without the rows of these times."""
    kept = []
    for one in recordings:
        time = np.asarray(one.time)
        inside = np.zeros(time.shape, dtype=np.bool_)
        for first, last in spans:
            inside |= (time >= first) & (time < last)
        kept.append(one.rows(~inside))
    return kept


def _fit_half(
    arm: SimulatedArm, equations: ArmEquations, number: np.ndarray, settings: GuidedSettings
) -> tuple[ArmFit, FloatArray, FloatArray]:
    """A plain fit to the half of the stretches of which it leaves least, what it leaves of each joint in each, and what
    it leaves of each joint in that half. Shapes (n_stretches, n_joints), not a number where a joint hardly moves, and
    (n_joints,)."""
    model, prior = ArmModel.build_plain(len(arm.joints)), ArmPrior()
    kept: BoolArray = np.ones(int(number.max()) + 1, dtype=np.bool_)
    fit = fit_arm(arm, equations, model, prior)
    for _ in range(settings.rounds):
        left, usual = _measure(equations, fit, number, kept, settings.rows)
        ratios = left / usual
        moving = np.any(np.isfinite(ratios), axis=1)
        score = np.full(kept.shape, np.inf)
        score[moving] = np.nanmedian(ratios[moving], axis=1)
        half = score <= np.median(score[moving])
        if np.array_equal(half, kept):
            break
        kept = half
        part = equations.with_rows(kept[number])
        part = replace(part, weights=replace(part.weights, noise=usual))
        fit = fit_arm(arm, part, model, prior, fit)
    return fit, *_measure(equations, fit, number, kept, settings.rows)


def _measure(
    equations: ArmEquations, fit: ArmFit, number: np.ndarray, kept: BoolArray, fewest: int
) -> tuple[FloatArray, FloatArray]:
    """RMS of what is left of each joint in each stretch, and in those that are kept."""
    squares = fit.residuals(equations) ** 2 * equations.moving
    pairs = [(squares[:, j], equations.moving[:, j].astype(np.float64)) for j in range(squares.shape[1])]
    sums, counts = (np.stack([np.bincount(number, pair[k], kept.size) for pair in pairs], axis=1) for k in range(2))
    left = np.where(counts >= fewest, np.sqrt(sums / np.maximum(counts, 1.0)), np.nan)
    usual = np.sqrt(np.sum(sums[kept], axis=0) / np.maximum(np.sum(counts[kept], axis=0), 1.0))
    return left, np.maximum(usual, 1e-12)


def _keep_rows(found: BoolArray, fewest: int) -> BoolArray:
    """What is found so many times in a row. Shape as given."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], found, [False]])))
    kept = np.zeros_like(found)
    for first, last in edges.reshape(-1, 2):
        kept[first:last] = last - first >= fewest
    return kept


def _join(spans: Sequence[tuple[float, float]]) -> Spans:
    """The same times, with spans that touch joined into one."""
    if not spans:
        return ()
    breaks = [k for k, (one, after) in enumerate(pairwise(spans), 1) if after[0] > one[1]]
    starts, ends = [0, *breaks], [*breaks, len(spans)]
    return tuple((spans[a][0], spans[b - 1][1]) for a, b in zip(starts, ends, strict=True))
