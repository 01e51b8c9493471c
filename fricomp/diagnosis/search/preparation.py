"""Base model, residual and nulls of a set of recordings: all that is needed before any effect is tried."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.ndimage import minimum_filter1d
from scipy.signal import lfilter

from fricomp.root_mean_square import compute_rms

from ..effects.context import build_contexts
from ..effects.structure import Structure
from ..effects.time_window import find_time_windows
from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray, Track, goes_one_way
from ..joint.base import BaseModel, unpack
from ..joint.base_fit import fit_base, fit_creep, fit_known, is_loud, try_other_bristle
from ..joint.nulls import Nulls, make_nulls
from ..joint.observer import Contribution, Observer, Plant
from ..joint.problem import Problem, build_problem
from ..joint.settings import JOINT
from ..joint.solver import Box, Fit, minimise
from ..joint.spectrum import estimate_floor, is_structured
from ..joint.weak_form import estimate_plants
from .first_look import describe_first_look
from .generic import build_generic_rows
from .hypotheses import narrow_starts
from .order import find_orders
from .screening import orthonormalise, project_out
from .settings import SEARCH


@dataclass(frozen=True)
class Baseline:
    """The base model fitted to the recordings.

    Attributes:
        problem: Recordings and weights.
        structure: The base alone, with the motion that effects are computed from.
        fit: The minimum.
        box: Domain of the base parameters.
        nulls: Recordings in which nothing is missing.
        recolouring: Filter that whitens the residual beyond what whitens the nulls, shape (4,); None where none does.
        rigid: Inertia and gravity as the simulation has them; None where none was given.
        structured: Whether what is left has lines or peaks over time that no null has: more than noise.
    """

    problem: Problem
    structure: Structure
    fit: Fit
    box: Box
    nulls: Nulls
    recolouring: FloatArray | None = None
    rigid: RigidJoint | None = None
    structured: bool = False

    @cached_property
    def basis(self) -> FloatArray:
        """Orthonormal columns of the base model. Shape (m, p)."""
        return orthonormalise(self.fit.jacobian)

    @cached_property
    def generic(self) -> FloatArray:
        """Weighted rows of the generic basis. Shape (m, d)."""
        return build_generic_rows(self.problem, self.structure.contexts)

    @cached_property
    def null_residuals(self) -> list[FloatArray]:
        """Nulls after the base is refitted to them, in weighted rows. Shapes (m,)."""
        basis = self.basis if self.recolouring is None else orthonormalise(self._whiten_jacobian(self.recolouring))
        return [vector - basis @ (basis.T @ vector) for vector in self.nulls.build_vectors()]

    def _whiten_jacobian(self, recolouring: FloatArray) -> FloatArray:
        """The base model's Jacobian, whitened as the nulls are. Shape (m, p)."""
        ends = np.cumsum([grid.centres.size for grid in self.problem.grids])[:-1]
        parts = np.split(self.fit.jacobian, ends)
        return np.concatenate([lfilter([1.0], recolouring, part, axis=0) for part in parts])

    @cached_property
    def sliding(self) -> NDArray[np.bool_]:
        """Rows in which the joint slides all the time; all of them where it hardly ever does. Shape (m,)."""
        parts = []
        for track, grid in zip(self.problem.tracks, self.problem.grids, strict=True):
            around = grid.window.size + round(SEARCH.settled_time / track.dt)
            slowest = minimum_filter1d(np.abs(track.velocity), around)[grid.centres]
            parts.append(slowest > SEARCH.sliding_speed * self.problem.observer.rest_speed)
        rows = np.concatenate(parts)
        return rows if np.mean(rows) > SEARCH.seldom else np.ones(rows.size, dtype=bool)

    @cached_property
    def noise_ratio(self) -> float:
        """Weighted residual over that of the nulls."""
        return self.measure_loudness(self.fit)

    def measure_loudness(self, fit: Fit) -> float:
        """Weighted residual of a fit over that of the nulls."""
        null = np.mean([vector @ vector for vector in self.null_residuals])
        return float(np.sqrt(fit.residual @ fit.residual / null))

    def measure_plain(self, fit: Fit) -> float:
        """Root mean square of the torque that a fit leaves in rows of sliding [N·m] or [N]: without weights, so that
        fits about other bases compare with it."""
        return compute_rms(np.concatenate(self.problem.unweigh(fit.residual))[self.sliding])

    def measure_typical_loudness(self, fit: Fit) -> float:
        """Typical row of sliding that a fit leaves, over that of the nulls."""
        nulls = [null[self.sliding] for null in self.null_residuals]
        return _compute_ratio(fit.residual[self.sliding], nulls, _compute_typical)


def prepare(
    tracks: Sequence[Track],
    *,
    observer: Observer,
    nulls: int,
    seed: int,
    rigid: RigidJoint | None = None,
    known: FloatArray | None = None,
    holds: bool = False,
    start: Plant | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Baseline:
    """Fit the base: first in weak form, then by observed simulation, weighted by nulls of the fitted plant.

    Args:
        tracks: The recordings.
        observer: Observer settings.
        nulls: Number of nulls.
        seed: Seed of their noise.
        rigid: Inertia and gravity as the simulation has them; a motion at one speed says nothing about the inertia.
        known: Base parameters from which to fit, shape (p,), where a search has shown them, as those of friction that
            creeps; None to find them.
        holds: Whether no friction that creeps is tried.
        start: The joint as far as it is known; None for the estimate in weak form.
        tell: Called with a first look at what the base leaves, in a sentence.
    """
    raw, fit, box = _fit_first(tracks, observer, rigid, start)
    fit, problem, _ = _reweigh(raw, fit, box, SEARCH.first_nulls, seed)
    tell(describe_first_look(problem, fit))
    fit = try_other_bristle(problem, fit, box)
    if known is not None:
        return _settle(raw, *fit_known(problem, known, box), (nulls, seed), rigid)
    if holds:
        return _settle(raw, fit, box, (nulls, seed), rigid)
    loud = is_loud(fit)
    fitted = _try_creep(raw, problem, fit, box, seed) if loud else (fit, box)
    baseline = _settle(raw, *fitted, (nulls, seed), rigid)
    if loud or baseline.noise_ratio < JOINT.loud:
        return baseline
    # The noise at rest of a bristle had passed for that of all rows.
    found, free = _try_creep(raw, baseline.problem, baseline.fit, box, seed)
    return baseline if found is baseline.fit else _settle(raw, found, free, (nulls, seed), rigid)


def _settle(raw: Problem, fit: Fit, box: Box, drawn: tuple[int, int], rigid: RigidJoint | None) -> Baseline:
    """The base about this fit, with the number of nulls and the seed that are `drawn`."""
    fit, problem, nulls = _reweigh(raw, fit, box, *drawn)
    baseline = Baseline(problem, build_structure(problem, fit, box), fit, box, nulls, rigid=rigid)
    return _level_noise(_recolour(baseline))


def _fit_first(
    tracks: Sequence[Track], observer: Observer, rigid: RigidJoint | None, start: Plant | None
) -> tuple[Problem, Fit, Box]:
    """Fit the base without weights. The second start counts only where the first one leads far astray."""
    top, tried = _find_top_speed(tracks), []
    delays = min(one.delays[0] for one in tracks), max(one.delays[1] for one in tracks)
    torques = max(float(np.std(one.torque)) for one in tracks), max(float(np.max(np.abs(one.torque))) for one in tracks)
    plants = estimate_plants(tracks, width=observer.width, known=rigid) if start is None else (start,)
    for plant in plants:
        first = plant if rigid is None else replace(plant, inertia=rigid.inertia)
        base = BaseModel.build_around(
            first, delays=delays, top_speed=top, torques=torques, rotary=tracks[0].rotary, known=rigid
        )
        problem = build_problem(tracks, first, observer)
        evaluate = problem.build_residual(problem.add_nothing)
        tried.append((problem, minimise(evaluate, base.start, base.box, iterations=10, refresh=2), base.box))
    usual, *others = tried
    return next((other for other in others if other[1].cost < SEARCH.astray_cost * usual[1].cost), usual)


def _try_creep(raw: Problem, problem: Problem, fit: Fit, box: Box, seed: int) -> tuple[Fit, Box]:
    """Return the fit and its domain, or those of friction that never holds, where it leaves no more than its own nulls
    do.

    Whatever is missing may look a little like creep, so it must explain all of what is left, all but a trace, or so
    much that no joint which sticks has been seen to let it explain. A joint that creeps shows more noise at rest than
    one that sticks, so it is judged by nulls of its own.
    """
    shown = may_creep(raw.tracks)
    tried = fit_creep(problem, fit, box) if shown else None
    if tried is None:
        return fit, box
    found, free = tried
    before, after = (float(one.residual @ one.residual) for one in (fit, found))
    torques = [compute_rms(np.concatenate(problem.unweigh(one.residual))) for one in (fit, found)]
    above = before - fit.residual.size
    explained = (before - after) / above if above > 0.0 else 0.0
    try:
        found, _, nulls = _reweigh(raw, found, free, SEARCH.first_nulls, seed)
    except FloatingPointError:
        return fit, box
    left = np.mean([vector @ vector for vector in nulls.build_vectors()])
    quiet = found.residual @ found.residual <= SEARCH.quiet_creep**2 * left
    less = after < SEARCH.creep_leaves * before or torques[1] ** 2 < SEARCH.creep_leaves * torques[0] ** 2
    accepted = (quiet and after < before) or explained > SEARCH.creep_explains or less
    return (found, free) if accepted else (fit, box)


def may_creep(tracks: Sequence[Track]) -> bool:
    """Whether motions show what tells friction that creeps from such that holds: one in one direction has no reversal,
    and whatever is missing there looks like a little creep."""
    return not goes_one_way([track.velocity for track in tracks])


def _find_top_speed(tracks: Sequence[Track]) -> float:
    """Find the speed that only 0.5 % of the samples exceed [rad/s]."""
    return max(float(np.quantile(np.abs(track.velocity), 0.995)) for track in tracks)


def _split_noise(baseline: Baseline) -> tuple[FloatArray, list[FloatArray]]:
    """Split off what neither the base nor any smooth torque reaches: of the residual, shape (m,), and of each null."""
    span = orthonormalise(
        np.concatenate([baseline.fit.jacobian, baseline.generic], axis=1),
        1e-6,
    )
    ours, *theirs = (
        project_out(v[:, None], span)[:, 0] for v in (baseline.fit.residual, *baseline.nulls.build_vectors())
    )
    return ours, theirs


def _recolour(baseline: Baseline) -> Baseline:
    """Whiten the residual by its own correlation where that differs from the nulls', which keep theirs.

    What swings at frequencies of its own is correlated as well, and is no noise.
    """
    ours, theirs = _split_noise(baseline)
    if is_structured(ours, theirs):
        return replace(baseline, structured=True)
    trimmed, bulk = (_compute_ratio(ours, theirs, size) for size in (_compute_trimmed, _compute_typical))
    if trimmed > min(SEARCH.noise_correction[1], bulk / SEARCH.even_excess):
        return baseline
    recolouring = _build_colour_filter(ours, np.mean([_correlate(one) for one in theirs], axis=0))
    if recolouring.size == 1:
        return baseline
    weights = baseline.nulls.weights
    whitener = np.convolve(weights.whitener, recolouring)
    problem = replace(baseline.problem, weights=replace(weights, whitener=whitener))
    evaluate = problem.build_residual(problem.add_nothing)
    fit = minimise(evaluate, baseline.fit.theta, baseline.box, iterations=6, refresh=2)
    return replace(baseline, problem=problem, fit=fit, recolouring=recolouring)


def _build_colour_filter(values: FloatArray, correlation: FloatArray) -> FloatArray:
    """Filter that gives `values` this correlation over one to three rows and keeps their size; (1,) where it is theirs.

    In several half steps: what the base takes out correlates rows as well, so correlations do not simply add.
    """
    found, filtered = np.ones(1), values
    for _ in range(SEARCH.colour_steps):
        shift = _correlate(filtered) - correlation
        if np.max(np.abs(shift)) < SEARCH.same_colour:
            break
        extra = _predict_stably(0.5 * shift)
        found = np.convolve(found, [1.0, *-extra])
        filtered = lfilter(found, [1.0], values)
    result: FloatArray = found * _compute_typical(values) / _compute_typical(filtered)
    return result


def _predict_stably(shift: FloatArray) -> FloatArray:
    """Predict from the last three rows by the correlations `shift`, made weaker until the inverse dies away."""
    for _ in range(SEARCH.fainter_tries):
        extra: FloatArray = solve_toeplitz(np.array([1.0, *shift[:-1]]), shift)
        if np.max(np.abs(np.roots([1.0, *-extra]))) < SEARCH.dying_root:
            return extra
        shift = 0.7 * shift
    return np.zeros_like(shift)


def _correlate(values: FloatArray) -> FloatArray:
    """Correlation over one to three rows, of values clipped at two typical deviations. Shape (3,)."""
    x = np.clip(values, -2.0 * _compute_typical(values), 2.0 * _compute_typical(values))
    return np.array([float(x[lag:] @ x[:-lag]) for lag in (1, 2, 3)]) / float(x @ x)


def _level_noise(baseline: Baseline) -> Baseline:
    """Scale the nulls to the part of the residual that neither the base nor any smooth torque reaches."""
    ours, theirs = _split_noise(baseline)
    usual = max(_compute_ratio(ours, theirs, _compute_typical), SEARCH.usual_excess)
    found = (
        _compute_ratio(ours, theirs, estimate_floor)
        if baseline.structured
        else min(_compute_ratio(ours, theirs, _compute_trimmed), usual)
    )
    factor = float(np.clip(found, *SEARCH.noise_correction))
    nulls, fit, own = baseline.nulls.scale(factor), baseline.fit, baseline.problem.weights
    # The priors in the cost know nothing of the noise.
    cost = fit.cost + (1.0 / factor**2 - 1.0) * float(fit.residual @ fit.residual)
    fit = replace(fit, residual=fit.residual / factor, jacobian=fit.jacobian / factor, cost=cost)
    weights = nulls.weights if own is None else replace(nulls.weights, whitener=own.whitener)
    return replace(baseline, problem=replace(baseline.problem, weights=weights), fit=fit, nulls=nulls)


def _compute_ratio(ours: FloatArray, theirs: Sequence[FloatArray], size: Callable[[FloatArray], float]) -> float:
    return float(size(ours) / np.mean([size(one) for one in theirs]))


def _compute_trimmed(values: FloatArray) -> float:
    """Standard deviation in which values beyond three robust ones count as three."""
    limit = 3.0 * _compute_typical(values)
    return float(np.sqrt(np.mean(np.minimum(values**2, limit**2))))


def _compute_typical(values: FloatArray) -> float:
    """Compute the standard deviation of the bulk. A bristle or a gap that is missed shows in few rows, noise in all."""
    return float(np.median(np.abs(values))) / 0.6745


def _reweigh(problem: Problem, fit: Fit, box: Box, count: int, seed: int) -> tuple[Fit, Problem, Nulls]:
    """Fit again with the weights of nulls of this fit."""
    plant, nothing = unpack(fit.theta), [Contribution()] * len(problem.tracks)
    problem, nulls = weigh_by_nulls(problem, plant, nothing, count, seed)
    return fit_base(problem, fit.theta, box), problem, nulls


def weigh_by_nulls(
    problem: Problem, plant: Plant, effects: Sequence[Contribution], count: int, seed: int
) -> tuple[Problem, Nulls]:
    """Improve the velocities once, as in each null, simulate nulls of a plant with effects, weigh rows by them."""
    problem = replace(problem.cut_samples_for(plant).improve_velocity(plant, effects), weights=None)
    nulls = make_nulls(problem, plant, effects, count=count, seed=seed)
    observer = replace(problem.observer, as_recorded=nulls.of_torque > SEARCH.noisy_torque)
    return replace(problem, weights=nulls.weights, observer=observer), nulls


def build_structure(problem: Problem, fit: Fit, box: Box) -> Structure:
    """Build the base alone, with its motion and the starts of effects that show in what it leaves.

    Raises:
        FloatingPointError: The base runs away in simulation.
    """
    plant = unpack(fit.theta)
    runs = problem.observe_finite(plant, [Contribution()] * len(problem.tracks))
    contexts = build_contexts(problem, plant, runs, {})
    basis = orthonormalise(fit.jacobian)
    hints = find_orders(problem, contexts, project_out(fit.residual[:, None], basis)[:, 0], basis)
    hints["window"] = find_time_windows(problem, contexts, fit, box)
    hints |= narrow_starts(problem, Structure(tuple(contexts)), fit.residual, basis)
    return Structure(tuple(replace(context, hints=hints) for context in contexts))
