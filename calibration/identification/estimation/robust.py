"""Identification with outliers: the likelihood of contaminated noise, from starts that part of the data did not see.

Each point is normal with the noise model's deviation, or with probability epsilon an outlier whose deviation is k
times that; epsilon, k and the level are estimated with the parameters by expectation-maximisation
[aitkin1980mixture]. This is a likelihood too, so basins can be compared.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .form import SeparableLaw
from .likelihood import Noise, Whitened
from .observation import Observations
from .optimum import Optimum, optimum_at, refine
from .start import Scan, project_on_columns, starting_points, with_sensitivity

_SUBSETS = 60
_SHAPES = 9
_SHAPE_FACTOR = 2.5
_KEPT_STARTS = 4
_APART = 2.0
"""Two starts are the same basin if their curves are everywhere closer than this many deviations."""
_REACH = 4.685
"""Deviations beyond which a point no longer counts in ranking starts: Tukey's constant [maronna2019robust]."""
_NORMAL_MAD = 0.6745
"""Median of |x| for a standard normal x."""


class _Contamination(NamedTuple):
    """Deviation of the bulk, share of outliers, and how much wider these spread."""

    deviation: float
    share: float
    widening: float


class _Candidate(NamedTuple):
    cost: float
    logs: FloatArray
    curve: FloatArray


def fit_robust(law: SeparableLaw, observations: Observations, noise: Noise, scan: Scan | None = None) -> Optimum:
    """Maximise the likelihood of contaminated noise.

    A few outliers at the lowest speeds can carry the static torque with them and look consistent. So starts also
    come from random halves of the points, of which some leave those outliers out.

    The result carries `given` noise: each point's deviation by its probability of being an outlier, so that
    everything that builds on it (network, covariance) gives a point the weight the fit gave it. A `scan` of the same
    points, for all noise of an unknown level, is not done again.

    Raises:
        IdentificationError: Too few points for the law.
    """
    first = starting_points(law, observations, noise, robust=True, scan=scan)[0]
    whitened = _whiten(first, law, observations, noise)
    deviation = _guess_contamination(whitened.residual, observations.torque_scale).deviation / whitened.weight
    starts = [first, *_find_subset_starts(law, observations, first, deviation)]
    fits = sorted(
        (_maximise_likelihood(start, law, observations, noise, 1e-2) for start in starts),
        key=lambda f: f.negative_log_likelihood,
    )
    best = _maximise_likelihood(fits[0].logs, law, observations, noise, 1e-7)
    rivals = [f for f in fits[1:] if np.max(np.abs(f.magnitude - best.magnitude) / deviation) > 1.0]
    wider = _widen(best, law, observations, noise)
    return replace(
        wider,
        negative_log_likelihood=best.negative_log_likelihood,
        other_basins=tuple(fit.negative_log_likelihood for fit in rivals),
    )


def _widen(best: Optimum, law: SeparableLaw, observations: Observations, noise: Noise) -> Optimum:
    """`best` with all deviations larger by one factor, since which points are outliers comes from the points too.

    Weights that are held promise the information of their mean; that of the mixture is the mean square of its score,
    which is a residual times its weight [maronna2019robust].
    """
    assert best.noise.deviation is not None
    precision = (best.noise.deviation * _whiten(best.logs, law, observations, noise).weight) ** -2.0
    score = float(np.sum(precision * best.whitened.residual**2))
    freedom = max(observations.size - len(best.logs), 1)
    factor = np.sqrt(max(float(np.sum(precision)) / max(score, 1e-300), 1.0) * observations.size / freedom)
    return optimum_at(best.logs, law, observations, Noise("given", factor * best.noise.deviation))


def _whiten(logs: FloatArray, law: SeparableLaw, observations: Observations, noise: Noise) -> Whitened:
    magnitude, jacobian = law.evaluate(logs, observations)
    return noise.whiten(observations.magnitude, magnitude, jacobian)


def _guess_contamination(residual: FloatArray, torque_scale: float) -> _Contamination:
    """A first guess from the median."""
    spread = float(np.median(np.abs(residual))) / _NORMAL_MAD
    return _Contamination(max(spread, 1e-12 * torque_scale), 0.1, 10.0)


def _maximise_likelihood(
    start: FloatArray, law: SeparableLaw, observations: Observations, noise: Noise, tolerance: float
) -> Optimum:
    logs, state, residual = start, None, np.empty(0)
    for _ in range(60):
        whitened = _whiten(logs, law, observations, noise)
        residual = whitened.residual
        state = _estimate_contamination(residual, state or _guess_contamination(residual, observations.torque_scale))
        precision = _compute_precision(residual, state)
        given = Noise("given", 1.0 / (whitened.weight * np.sqrt(precision)))
        fit = refine(logs, law, observations, given, evaluations=4)
        moved, logs = float(np.max(np.abs(fit.logs - logs))), fit.logs
        if moved < tolerance:
            break
    assert state is not None
    outlier, bulk = _compute_densities(residual, state)
    density = float(np.sum(np.log(outlier + bulk + 1e-300)))
    units = 0.0 if noise.deviation is None else float(np.sum(np.log(noise.deviation)))
    return replace(fit, negative_log_likelihood=units - density)


def _estimate_contamination(residual: FloatArray, state: _Contamination) -> _Contamination:
    """Expectation-maximisation of the mixture with the residuals held."""
    least = state.deviation * 1e-6
    for _ in range(30):
        outlier, bulk = _compute_densities(residual, state)
        probability = outlier / (outlier + bulk + 1e-300)
        deviation = max(float(np.sqrt(np.average(residual**2, weights=1.0 - probability + 1e-9))), least)
        wide = float(np.sqrt(np.average(residual**2, weights=probability + 1e-9)))
        share = float(np.clip(np.mean(probability), 1e-3, 0.4))
        state = _Contamination(deviation, share, float(np.clip(wide / deviation, 3.0, 100.0)))
    return state


def _compute_densities(residual: FloatArray, state: _Contamination) -> tuple[FloatArray, FloatArray]:
    """Densities of the outliers and of the bulk, each times its share."""
    narrow, wide = state.deviation, state.deviation * state.widening
    root = np.sqrt(2.0 * np.pi)
    outlier = state.share / (wide * root) * np.exp(-0.5 * (residual / wide) ** 2)
    return outlier, (1.0 - state.share) / (narrow * root) * np.exp(-0.5 * (residual / narrow) ** 2)


def _compute_precision(residual: FloatArray, state: _Contamination) -> FloatArray:
    """Expected inverse variance of each point."""
    outlier, bulk = _compute_densities(residual, state)
    probability = outlier / (outlier + bulk + 1e-300)
    return (1.0 - probability + probability / state.widening**2) / state.deviation**2


def _find_subset_starts(
    law: SeparableLaw, observations: Observations, first: FloatArray, deviation: FloatArray
) -> list[FloatArray]:
    """Starts from random halves: the best of each branch together, then each branch's others beside the best."""
    rng = np.random.default_rng(0)
    branches = []
    for k, rows in enumerate(law.branches(observations)):
        at = first[k * law.branch_size : (k + 1) * law.branch_size]
        points = observations.select(np.flatnonzero(rows))
        branches.append(_find_branch_starts(law, points, at, 1.0 / deviation[rows], rng))
    best = [candidates[0].logs for candidates in branches]
    combinations = [best]
    for k, candidates in enumerate(branches):
        combinations += [[*best[:k], other.logs, *best[k + 1 :]] for other in candidates[1:]]
    return [with_sensitivity(law, np.concatenate(combination)) for combination in combinations]


def _find_branch_starts(
    law: SeparableLaw, points: Observations, first: FloatArray, weight: FloatArray, rng: np.random.Generator
) -> list[_Candidate]:
    at = law.shapes_of(np.exp(first))
    factors = np.geomspace(1.0 / _SHAPE_FACTOR, _SHAPE_FACTOR, _SHAPES).tolist()
    shapes = [(factor * at[0], *at[1:]) for factor in factors] if at else [()]
    factor, found = law.load_factor(points.normal_load, 1.0), []
    columns = [law.basis.columns(points.speed, one) * factor for one in shapes]
    for _ in range(_SUBSETS):
        half = np.sort(rng.choice(points.size, max(points.size // 2, law.branch_size), replace=False))
        for one, all_rows in zip(shapes, columns, strict=True):
            rows = all_rows[half]
            logs = project_on_columns(law, rows, points.magnitude[half], weight[half], one, robust=False).logs
            curve = all_rows @ np.exp(logs[law.linear_index]) * weight
            inside = np.maximum(1.0 - ((points.magnitude * weight - curve) / _REACH) ** 2, 0.0)
            found.append(_Candidate(float(np.sum(1.0 - inside**3)), logs, curve))
    return _select_distinct(sorted(found, key=lambda candidate: candidate.cost))


def _select_distinct(ranked: list[_Candidate]) -> list[_Candidate]:
    """The best few whose curves differ."""
    kept: list[_Candidate] = []
    for candidate in ranked:
        if all(np.max(np.abs(candidate.curve - other.curve)) > _APART for other in kept):
            kept.append(candidate)
        if len(kept) == _KEPT_STARTS:
            break
    return kept
