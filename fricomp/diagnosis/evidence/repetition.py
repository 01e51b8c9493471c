"""Stability selection: the choice made again on parts of the rows, weighed by nulls that are drawn again.

About the minimum of each explanation its refit to a part of the rows is one Gauss-Newton step, so that a hundred
choices cost less than one search. The share of repetitions that give a name bounds how often it is false
[meinshausen2010stability].
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fricomp.root_mean_square import compute_rms

from ..inputs.track import FloatArray
from ..joint.nulls import compute_row_spread
from ..joint.solver import Box, Fit, raise_diagonal
from ..search.choice import choose
from ..search.explanation import Explanation, compute_evidence, curb
from ..search.preparation import Baseline
from ..search.screening import orthonormalise, project_out
from ..search.search import SearchResult
from ..search.settings import SEARCH
from .confirmation import compute_covariance
from .gates import covers, stands_out
from .refitted import RefittedJoint
from .settings import REPETITIONS

__all__ = ["Repetitions", "refit_parts", "repeat_choice"]

_Rows = NDArray[np.bool_]


@dataclass(frozen=True)
class Repetitions:
    """How often each answer came.

    Attributes:
        count: Number of repetitions that hold rows in which the chosen effects act.
        sets: How often each set of names was chosen, names sorted.
        nothing: How often nothing stood out.
        unknown: How often something stood out that could not be named.
        unmet: How many repetitions hold no rows in which an effect acts, and do not give its name: they say nothing
            against it.
    """

    count: int
    sets: dict[tuple[str, ...], int] = field(default_factory=dict)
    nothing: int = 0
    unknown: int = 0
    unmet: dict[str, int] = field(default_factory=dict)

    def compute_share(self, *names: str) -> float:
        """Part of the repetitions that give all of these names, of those that could."""
        return sum(n for one, n in self.sets.items() if set(names) <= set(one)) / self._count_heard(names)

    def compute_share_of_any(self, names: Collection[str]) -> float:
        """Part of the repetitions that give at least one of these names, of those that could."""
        return sum(n for one, n in self.sets.items() if set(names) & set(one)) / self._count_heard(names)

    def _count_heard(self, names: Collection[str]) -> int:
        return max(self.count - max(self.unmet.get(name, 0) for name in names), 1)

    @property
    def shares(self) -> dict[str, float]:
        """Part of the repetitions that give each name, the most frequent first."""
        names = sorted({name for one in self.sets for name in one})
        return dict(sorted(((name, self.compute_share(name)) for name in names), key=lambda pair: -pair[1]))


def repeat_choice(baseline: Baseline, found: SearchResult) -> Repetitions:
    """Choose again on parts of the rows.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        found: Explanations of all rows, best first.
    """
    trial = _Trial(baseline, found)
    parts = [(trial.choose_on(rows, factor), rows) for rows, factor in draw_parts(baseline)]
    parts = [(answer, rows) for answer, rows in parts if answer != "nothing" or trial.is_reached(rows)]
    answers = [answer for answer, _ in parts]
    sets = Counter(answer for answer in answers if isinstance(answer, tuple))
    unmet = {
        name: sum(name not in answer and not trial.is_reached(rows, name) for answer, rows in parts)
        for name in (() if found.best is None else found.best.names)
    }
    return Repetitions(len(answers), dict(sets), answers.count("nothing"), answers.count("unknown"), unmet)


def refit_parts(baseline: Baseline, chosen: Explanation | None) -> list[RefittedJoint]:
    """Refit the base with the chosen effects, or alone, to each of the same parts of the rows.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        chosen: The effects; None for the base alone.
    """
    one = baseline if chosen is None else chosen
    box = one.box.join(one.structure.build_known_box()) if one.structure.candidates else one.box
    line, covariance = _Linear(one.fit, box, np.zeros((one.fit.residual.size, 0)), 0.0), None
    joints = []
    for rows, factor in draw_parts(baseline):
        fit = line.move_to(rows, factor)
        if covariance is None:
            covariance = compute_covariance(one.fit, box) / float(np.mean(rows))
        joints.append(RefittedJoint(one.structure, fit, covariance))
    return joints


def draw_parts(baseline: Baseline) -> Iterator[tuple[_Rows, FloatArray]]:
    """Parts of the rows, with the factor that another draw of nulls puts on each row."""
    size, rng = baseline.fit.residual.size, np.random.default_rng(REPETITIONS.seed)
    number = max(REPETITIONS.fewest_blocks, size // REPETITIONS.block)
    blocks = np.array_split(np.arange(size), number)
    out = max(1, round(REPETITIONS.left_out * number))
    usual = [compute_row_spread(one, one.mean(axis=0)) for one in baseline.nulls.rows]
    for k in range(REPETITIONS.blocks + REPETITIONS.cuts):
        rows = np.ones(size, dtype=bool)
        if k < REPETITIONS.blocks:
            for block in rng.choice(number, out, replace=False):
                rows[blocks[block]] = False
        else:
            cut = round((1.0 - REPETITIONS.left_out) * size * (k - REPETITIONS.blocks) / (REPETITIONS.cuts - 1))
            rows[cut : cut + round(REPETITIONS.left_out * size)] = False
        yield rows, _draw_factor(baseline, usual, rng)


def _draw_factor(baseline: Baseline, usual: Sequence[FloatArray], rng: np.random.Generator) -> FloatArray:
    """Spread of each row by all nulls, the `usual` one, over that by as many of them drawn again. Shape (m,)."""
    parts = []
    for rows, whole in zip(baseline.nulls.rows, usual, strict=True):
        drawn = rows[rng.integers(0, rows.shape[0], rows.shape[0])]
        ratio = whole / compute_row_spread(drawn, drawn.mean(axis=0))
        parts.append(ratio / compute_rms(ratio))
    return np.concatenate(parts)


@dataclass(frozen=True, eq=False)
class _Thinned(Explanation):
    """An explanation on a part of the rows.

    Attributes:
        reach: What its effects add to each of these rows, asked for only where a choice hangs on it.
    """

    reach: Callable[[], FloatArray] = field(default=lambda: np.zeros(0))

    def compute_reach(self, baseline: Baseline) -> FloatArray:
        """What its effects add to each row, in units of the noise."""
        return self.reach()


@dataclass(frozen=True)
class _Linear:
    """A fit as a line about its minimum, on any part of the rows.

    Attributes:
        fit: The fit.
        box: Domain and priors of all its parameters.
        generic: Generic basis beside its Jacobian, orthonormal. Shape (m, d).
        whole: What a generic basis explains of it on all rows beyond chance, as the search counts it.
    """

    fit: Fit
    box: Box
    generic: FloatArray
    whole: float

    def move_to(self, rows: _Rows, factor: FloatArray) -> Fit:
        """The fit to a part of the rows, each weighed by a factor, with residual and cost there."""
        free, scaled, prior, held = self._whole
        A, r = scaled[rows] * factor[rows, None], self.fit.residual[rows] * factor[rows]
        pull = A.T @ r - held
        # Cut along the axes of the bowl, where a shorter step never climbs; cut by numbers that trade against each
        # other it would leave the valley.
        curvature, axes = np.linalg.eigh(A.T @ A + prior)
        along = np.clip(axes.T @ pull / curvature, -REPETITIONS.longest_step, REPETITIONS.longest_step)
        step = -axes @ along
        residual = r + A @ step
        priors = self.fit.cost - float(self.fit.residual @ self.fit.residual)
        theta = self.fit.theta.copy()
        theta[free] += self.box.scale[free] * step
        return Fit(self.box.clip(theta), residual, self.fit.jacobian[rows], float(residual @ residual) + priors)

    @cached_property
    def _whole(self) -> tuple[_Rows, FloatArray, FloatArray, FloatArray]:
        """Which parameters are free, their scaled columns, their priors, and what the priors pull against on all rows
        at the minimum."""
        A = self.fit.jacobian * self.box.scale
        free = np.any(A != 0.0, axis=0)
        A = A[:, free]
        prior = raise_diagonal(self.box.scaled_precision[np.ix_(free, free)], 1e-6)
        return free, A, prior, A.T @ self.fit.residual

    @cached_property
    def forgiven(self) -> float:
        """What is not held against it on all rows, such as the form of the bristle about rest."""
        return max(_compute_excess(self.generic, self.fit.residual) - self.whole, 0.0)

    def compute_explainable(self, rows: _Rows, residual: FloatArray) -> float:
        """What a generic basis explains of a residual on a part of the rows, beyond chance."""
        out = self.generic[~rows]
        squares = np.eye(self.generic.shape[1]) - out.T @ out + REPETITIONS.ridge * np.eye(self.generic.shape[1])
        spread = np.zeros(rows.size)
        spread[rows] = residual
        along = self.generic.T @ spread
        return float(along @ np.linalg.solve(squares, along) - self.generic.shape[1])

    def compute_left(self, rows: _Rows, fit: Fit) -> float:
        """What a generic basis explains of what a fit to a part of the rows leaves."""
        return max(self.compute_explainable(rows, fit.residual) - float(np.mean(rows)) * self.forgiven, 0.0)


@dataclass(frozen=True)
class _Trial:
    """The choice that is repeated.

    Attributes:
        baseline: The base on all rows.
        found: What was found on them.
    """

    baseline: Baseline
    found: SearchResult

    @cached_property
    def explanations(self) -> list[Explanation]:
        """Those that are chosen from: near the best, and all parts of the chosen one."""
        best = self.found.best
        gain = max((one.gain for one in self.found.explanations if not one.refused), default=0.0)
        own = [one for one in self.found.explanations if best is not None and set(one.names) <= set(best.names)]
        near = [one for one in self.found.explanations if one.gain > REPETITIONS.near * gain and one not in own]
        return [*own, *near[: REPETITIONS.explanations]]

    @cached_property
    def lines(self) -> list[_Linear]:
        """Each explanation as a line."""
        return [
            self._linearise(one.fit, one.box.join(one.structure.build_box()), one.left) for one in self.explanations
        ]

    @cached_property
    def base(self) -> _Linear:
        """The base as a line."""
        return self._linearise(self.baseline.fit, self.baseline.box, self.found.explainable)

    @cached_property
    def reaches(self) -> dict[tuple[int, tuple[str, ...]], FloatArray]:
        """What effects of explanations add to each row, by place and names, of those that were asked for."""
        return {}

    def compute_reach(self, index: int, *names: str) -> FloatArray:
        """What the effects of one explanation, or these of them, add to each row, simulated once. Shape (m,)."""
        one, at = self.explanations[index], (index, names or self.explanations[index].names)
        if at not in self.reaches:
            self.reaches[at] = one.structure.compute_added(self.baseline.problem, one.fit.theta, at[1])
        return self.reaches[at]

    def is_reached(self, rows: _Rows, *names: str) -> bool:
        """Whether the chosen effects, or these of them, act in a part of the rows: what is met once, such as a limit,
        is not missed in the rest.
        """
        if self.found.best is None:
            return True
        reach = self.compute_reach(self.explanations.index(self.found.best), *names) ** 2
        return float(np.sum(reach[rows])) > REPETITIONS.reached * float(np.sum(reach))

    def _linearise(self, fit: Fit, box: Box, whole: float) -> _Linear:
        span = orthonormalise(project_out(self.baseline.generic, orthonormalise(fit.jacobian)), 1e-4)
        return _Linear(fit, box, span, whole)

    def choose_on(self, rows: _Rows, factor: FloatArray) -> tuple[str, ...] | str:
        """The names that are chosen on a part of the rows, "nothing" or "unknown"."""
        share = float(np.mean(rows))
        base = self.base.move_to(rows, factor)
        baseline = self._thin_baseline(base, rows)
        tried = [self._thin(index, rows, factor, baseline) for index in range(len(self.lines))]
        threshold = share * self.found.threshold
        best = choose(baseline, tried, threshold)
        explainable = self.base.compute_explainable(rows, curb(base.residual))
        found = replace(self.found, explanations=tuple(tried), best=best, threshold=threshold, explainable=explainable)
        if best is not None and covers(best, found, baseline, REPETITIONS.slack):
            named = best.common_order is None and not best.foreign_curve
            return best.names if named else "unknown"
        return "unknown" if stands_out(found, baseline) else "nothing"

    def _thin_baseline(self, base: Fit, rows: _Rows) -> Baseline:
        """The base on a part of the rows. What it caches is the part of what was computed of all rows."""
        thinned = replace(self.baseline, fit=base)
        vars(thinned).update(
            sliding=self.baseline.sliding[rows], null_residuals=[one[rows] for one in self.baseline.null_residuals]
        )
        return thinned

    def _thin(self, index: int, rows: _Rows, factor: FloatArray, baseline: Baseline) -> Explanation:
        """One explanation on a part of the rows."""
        one, line = self.explanations[index], self.lines[index]
        fit = line.move_to(rows, factor)
        fall, left = baseline.fit.cost - fit.cost, line.compute_left(rows, fit)
        penalty = one.structure.freedom * float(np.log(fit.residual.size))
        coverage = fall / (fall + left) if fall > 0.0 else 0.0
        plain = fall > SEARCH.plain_gain * fit.residual.size and coverage > SEARCH.plain_coverage
        certain = compute_evidence(baseline, one.names, baseline.fit, fit, plain=plain)
        return _Thinned(
            one.structure, fit, one.box, fall - penalty, certain - penalty, float(coverage), left, one.refused,
            one.before, reach=lambda: self.compute_reach(index)[rows],
        )  # fmt: skip


def _compute_excess(span: FloatArray, residual: FloatArray) -> float:
    return float(np.sum((span.T @ residual) ** 2) - span.shape[1])
