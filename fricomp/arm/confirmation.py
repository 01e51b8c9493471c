"""Whether what was taken in comes again: in halves of the recording, and on data that took no part in the fit.

A term that one half of the blocks of a recording asks for and the other half does not is chance. The share of halves
in which it comes again is kept with it; drawn in complementary pairs, it bounds how many false ones there are
[shah2013].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .coordinates import ArmModel
from .equation_sums import EquationSums
from .equations import ArmEquations
from .fit import ArmFit, fit_arm
from .friction import JointForm
from .prior import ArmPrior
from .rigid.simulated_arm import SimulatedArm
from .row_weights import BoolArray
from .rows import ArmRows
from .search.ripple import RippleSearch

_PAIRS = 5
_BLOCKS = 20
"""Blocks that a recording is cut into; a half are ten of them, so that each half meets all of the motion."""

_FOLDS = 4

_STEPS = 5
"""Gauss-Newton steps of a fit to the blocks that are not left out, from a fit to all of them."""

_FAR_STEPS = 150
"""The same where links may be far off that were not: on the way there their equations are not linear, and what has not
arrived leaves more than it would."""

_MEANS = (0.1, 0.2)
"""[s] over which errors are averaged where it is asked how much a term matters: a tenth of a short stroke, and a fifth.
The longer they are, the less noise is in them, and the more of what is left is a term that acts for as long; what a
model has wrong stays. Over longer ones, terms that come by chance lower the error by nearly a tenth as well."""

_SURE = 2.0
"""Standard deviations of chance by which means must have more in common than none."""

_TOLD_APART = 1e-3
"""Part of the largest below which what a few rows tell of plain friction counts as nothing: where a joint hardly goes
back, its Coulomb and its constant torque are one, and their difference would be anything."""


@dataclass(frozen=True)
class HeldOutErrors:
    """Root mean square errors of each joint on rows held out of the fit [N·m] or [N]. Shape (n_joints,) each, except
    `means`.

    Attributes:
        simulation: Of the simulation's inverse dynamics, with a Coulomb, a viscous and a constant torque fitted.
        plain: Of links, rotors and such friction fitted together.
        model: Of the whole model.
        means: Of the whole model, over means of 0.1 and 0.2 s. Shape (2, n_joints).
        weighted: Of the whole model, over rows that count as much as they do in the fit.
        lasting: Of the whole model, what means of 0.2 s surely share with the next one that has other noise.
    """

    simulation: FloatArray
    plain: FloatArray
    model: FloatArray
    means: FloatArray
    weighted: FloatArray
    lasting: FloatArray


class ConfirmedData:
    """A recording cut into blocks, whose sums are added up once.

    Attributes:
        equations: Of all rows.
        prior: How far the simulation is trusted.
        rows: Motion and torques.
    """

    def __init__(self, arm: SimulatedArm, equations: ArmEquations, prior: ArmPrior, rows: ArmRows) -> None:
        self.equations, self.prior, self.rows = equations, prior, rows
        self._arm, self._ripples = arm, RippleSearch(rows, arm.rotary)
        self._block = np.arange(len(rows)) * _BLOCKS // len(rows)
        self._spans = [_list_spans(rows, mean) for mean in _MEANS]
        self._sums = equations.split(self._block)
        self._trained = [
            EquationSums.join([one for k, one in enumerate(self._sums) if k % _FOLDS != fold]) for fold in range(_FOLDS)
        ]

    def measure_stability(self, fit: ArmFit, seed: int = 0) -> dict[tuple[int, str], float]:
        """Share of halves of the recording in which each term of each joint makes it more probable."""
        rng = np.random.default_rng(seed)
        votes: dict[tuple[int, str], list[bool]] = {
            (j, name): [] for j, form in enumerate(fit.model.forms) for name in form.names if name != "stribeck"
        }
        for _ in range(_PAIRS) if votes else ():
            first = rng.permutation(_BLOCKS) % 2 == 0
            for half in (first, ~first):
                part = EquationSums.join([one for one, kept in zip(self._sums, half, strict=True) if kept])
                whole = fit_arm(self._arm, part, fit.model, self.prior, fit, steps=3)
                for (j, name), seen in votes.items():
                    less = fit_arm(self._arm, part, fit.model.without_terms(j, name), self.prior, whole, steps=3)
                    again = name != "cogging" or self._finds_order_again(j, less, half[self._block])
                    seen.append(whole.log_evidence > less.log_evidence and again)
        return {key: float(np.mean(seen)) for key, seen in votes.items()}

    def _finds_order_again(self, joint: int, without: ArmFit, kept: BoolArray) -> bool:
        """Whether these rows alone have their strongest wave where the whole recording has it."""
        left = without.residuals(self.equations)[:, joint] * self.equations.weights.rows[:, joint]
        order = self._ripples.find_order(joint, left, kept)
        return abs(order - float(self.equations.ripple[joint])) < self._ripples.resolve(joint)

    def measure_errors(self, fit: ArmFit) -> HeldOutErrors:
        """Errors of the simulation, of a plain model and of the whole model, each fitted to the other blocks."""
        plain = replace(fit.model, forms=tuple(JointForm() for _ in fit.model.forms), pinned=frozenset())
        fold, moving = self._block % _FOLDS, self.equations.moving.astype(np.float64)
        left = self.leave_out(fit.model, fit)
        whole, means, weighted = self._measure(left)
        simulated = [fit_plainly(self._arm, self.equations, fold != k)[1] for k in range(_FOLDS)]
        return HeldOutErrors(
            simulation=_measure_rows(_join_folds(fold, simulated), moving),
            plain=_measure_rows(self.leave_out(plain, fit), moving),
            model=whole,
            means=means,
            weighted=weighted,
            lasting=_measure_lasting(self.equations, left, self._spans[-1], _count_spans(self.rows.cutoff)),
        )

    def measure_model(self, model: ArmModel, start: ArmFit) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Held-out errors of one model over rows, over means, and over rows by their weights [N·m] or [N].

        How much a term matters should not hang on the bandwidth at which the parameters are known best: single rows
        are the noisier the closer they are. And rows about a reversal, at which joints stick, are no place to see what
        acts elsewhere.

        Returns:
            Shapes (n_joints,), (2, n_joints) and (n_joints,).
        """
        return self._measure(self.leave_out(model, start))

    def _measure(self, left: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The same of what a model leaves. Shape (n, n_joints)."""
        means = [_measure_means(self.equations, left, spans) for spans in self._spans]
        weights = self.equations.weights.rows
        return (
            _measure_rows(left, self.equations.moving.astype(np.float64)),
            np.stack(means),
            _measure_rows(left, weights),
        )

    def leave_out(self, model: ArmModel, start: ArmFit) -> FloatArray:
        """What one model leaves of rows by fits from `start` to blocks that they are not in. Shape (n, n_joints)."""
        steps = _STEPS if model.opened == start.model.opened else _FAR_STEPS
        fits = [fit_arm(self._arm, part, model, self.prior, start, steps=steps) for part in self._trained]
        return _join_folds(self._block % _FOLDS, [one.residuals(self.equations) for one in fits])


def _join_folds(fold: NDArray[np.intp], left: Sequence[FloatArray]) -> FloatArray:
    """What each fold leaves of the rows that it was not fitted to. Shape (n, n_joints)."""
    return np.asarray(np.stack(left)[fold, np.arange(fold.size)])


def _measure_rows(left: FloatArray, weights: FloatArray) -> FloatArray:
    """RMS over rows by their weights. Shape (n_joints,)."""
    return np.asarray(np.sqrt(np.sum(weights * left**2, axis=0) / np.maximum(np.sum(weights, axis=0), 1e-300)))


def _list_spans(rows: ArmRows, mean: float) -> NDArray[np.intp]:
    """First rows of spans of so many seconds, none of which goes over a gap."""
    number = np.floor(rows.time / mean).astype(np.intp)
    changes = (np.diff(number) != 0) | (np.diff(rows.part) != 0)
    return np.asarray(np.concatenate([[0], np.flatnonzero(changes) + 1]), dtype=np.intp)


def _count_spans(cutoff: float) -> int:
    """Spans from one to the next whose noise, of a band up to `cutoff` [Hz], is another."""
    return max(1, math.ceil(0.5 / (cutoff * _MEANS[-1]) - 1e-9))


def _measure_lasting(equations: ArmEquations, left: FloatArray, spans: NDArray[np.intp], apart: int) -> FloatArray:
    """RMS of what the means of spans have in common with those that many spans later, beyond what chance makes of them.

    Noise of a torque or an encoder is another in each. Shape (n_joints,).
    """
    count = np.add.reduceat(equations.moving.astype(np.float64), spans, axis=0)
    means = np.add.reduceat(np.where(equations.moving, left, 0.0), spans, axis=0) / np.maximum(count, 1.0)
    weights = np.sqrt(count[apart:] * count[:-apart])
    shared, total = weights * means[apart:] * means[:-apart], np.maximum(np.sum(weights, axis=0), 1.0)
    sure = np.sum(shared, axis=0) - _SURE * np.sqrt(np.sum(shared**2, axis=0))
    return np.asarray(np.sqrt(np.maximum(sure, 0.0) / total))


def _measure_means(equations: ArmEquations, left: FloatArray, spans: NDArray[np.intp]) -> FloatArray:
    """RMS over the means of spans, each of the rows in it that are compared. Shape (n_joints,)."""
    count = np.add.reduceat(equations.moving.astype(np.float64), spans, axis=0)
    sums = np.add.reduceat(np.where(equations.moving, left, 0.0), spans, axis=0)
    return np.asarray(
        np.sqrt(np.sum(sums**2 / np.maximum(count, 1.0), axis=0) / np.maximum(np.sum(count, axis=0), 1.0))
    )


def fit_plainly(arm: SimulatedArm, equations: ArmEquations, trained: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Coulomb, constant and viscous torques beside the simulation's inverse dynamics.

    Args:
        arm: The simulation.
        equations: Of all joints.
        trained: Rows that they are fitted to. Shape (n,).

    Returns:
        The three of each joint, shape (n_joints, 3), and what they leave of all rows, shape (n, n_joints).
    """
    first = arm.inertia.size
    found, left = [], []
    for j, columns in enumerate(equations.columns):
        torque = columns[:, -1] - columns[:, :first] @ arm.inertia.ravel() - arm.armature[j] * columns[:, first]
        friction = columns[:, first + 1 : first + 4]
        kept = trained & equations.moving[:, j]
        size = np.maximum(np.sqrt(np.mean(friction**2, axis=0)), 1e-300)
        values = np.linalg.lstsq(friction[kept] / size, torque[kept], rcond=_TOLD_APART)[0] / size
        found.append(values)
        left.append(torque - friction @ values)
    return np.array(found), np.stack(left, axis=1)
