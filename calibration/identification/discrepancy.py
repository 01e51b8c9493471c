"""Where the data depart from the law: a network between the closed form and the data, as far as held-out points ask.

The network starts as the closed form and is trained on the data and, at points of its own over a wider range, on the
closed form with a weight. A large weight gives the closed form, none a purely data-driven network; cross-validation
chooses, each fold from the closed form of the points it was left. Outside the data the closed form stays what holds it.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from ..network import TanhNetwork
from ..network.training import TrainingLimits, train_network
from .estimation.gathering import gather_points
from .estimation.likelihood import Noise
from .estimation.observation import Observations, list_places
from .estimation.optimum import Optimum, fit_likelihood, optimum_at
from .result import IdentificationResult

DATA_DRIVEN = 1e-8
"""Weight of the closed form in a network that is purely data-driven; not zero, to keep the training well posed."""
WEIGHTS = (np.inf, 100.0, 10.0, 1.0, 0.1, DATA_DRIVEN)
"""Weights of the closed form that are compared, in the order in which the network is trained through them."""
_EVIDENCE = 2.0
"""Standard errors by which held-out points must be predicted better before the closed form is left."""
_FOLDS = 4
_LEAST_SPEEDS = 20
_ONE_SPEED = 0.005
"""Speeds that differ by less than about this fraction are visits to one, and are left out together."""
_MOST_LOADS = 8
"""Up to so many distinct loads are left out one by one; of more, the random folds hold out enough."""
_ITERATIONS = 30
_MOST_POINTS = 1000
"""Points from which on means of neighbours are trained on; there are about half as many of them."""
_PER_SIDE = 50
_WIDER = 1.5
"""The closed form holds the network up to this multiple of the fastest speed measured."""


@dataclass(frozen=True)
class DiscrepancyNetwork:
    """A network that follows the data where they depart from the law.

    Attributes:
        network: The network of the chosen weight; the closed form's own where nothing else predicts better.
        weight: Weight of the closed form against the data; infinite for the closed form.
        held_out: Root mean square error on held-out points in units of their noise, by weight.
        message: What was chosen and why.
    """

    network: TanhNetwork
    weight: float
    held_out: dict[float, float]
    message: str

    @property
    def departs(self) -> bool:
        """Whether held-out points asked for it."""
        return bool(np.isfinite(self.weight))


class _Anchor(NamedTuple):
    """Where the closed form holds the network."""

    velocity: FloatArray
    normal_load: FloatArray | None
    torque: FloatArray


def fit_discrepancy(result: IdentificationResult, *, seed: int = 0) -> DiscrepancyNetwork:
    """Let the exported network depart from the closed form if held-out points are predicted better.

    The closed form is kept unless another weight is better by more than two standard errors of the difference.

    Args:
        result: An identification.
        seed: Seed of the folds.

    Raises:
        IdentificationError: Fewer than 20 different speeds, forward and reverse ones counted apart.
    """
    result = _gather(result)
    points = result.observations
    predictions = [_fit_held_out(result, outside) for outside in _draw_folds(points, seed)]
    rows = np.concatenate([fold.rows for fold in predictions])
    variance = _compute_deviation(result)[rows] ** 2
    scores = {w: np.concatenate([fold.squared_error[w] for fold in predictions]) / variance for w in WEIGHTS}
    chosen = _choose(scores)
    network = result.network
    for weight in WEIGHTS[1 : WEIGHTS.index(chosen) + 1]:
        network = train_towards(network, result, result.optimum, points, weight)
    held_out = {weight: float(np.sqrt(np.mean(values))) for weight, values in scores.items()}
    return DiscrepancyNetwork(network, chosen, held_out, _describe_choice(chosen, held_out))


def _gather(result: IdentificationResult) -> IdentificationResult:
    """The result with means of neighbouring points in place of many, each known to its own deviation.

    A training solves a system with a row a point. Points that are known each to their own deviation stay as they are.
    """
    points, at = result.observations, result.optimum
    given = at.noise.deviation
    if points.size <= _MOST_POINTS or (given is not None and float(np.ptp(given)) > 0.0):
        return result

    def curve(some: Observations) -> FloatArray:
        return result.form.evaluate(at.logs, some)[0]

    means = gather_points(points, curve, most=_MOST_POINTS, spread=False)
    level = np.sqrt(at.noise.variance(at.whitened.residual, len(result.parameter_names)))
    plain = optimum_at(at.logs, result.form, means, at.noise.counting(means)).whitened.weight
    means = replace(means, count=None)
    fitted = optimum_at(at.logs, result.form, means, Noise("given", level / plain))
    return replace(result, observations=means, rows=means, optimum=fitted)


class _HeldOut(NamedTuple):
    """Squared errors [(N·m)^2] or [N^2] at points left out, by weight, and which points these are."""

    rows: np.ndarray[tuple[int], np.dtype[np.intp]]
    squared_error: dict[float, FloatArray]


def _draw_folds(points: Observations, seed: int) -> list[np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Masks of points to leave out: random quarters, and each load between others, which asks more of a network.

    Visits to one speed under one load stay together: beside another visit a point would not be held out.

    Raises:
        IdentificationError: Fewer than 20 speeds.
    """
    place = [points.sign, np.round(np.log(points.speed) / _ONE_SPEED)]
    place += [] if points.normal_load is None else [points.normal_load]
    different, visit = np.unique(np.stack(place), axis=1, return_inverse=True)
    n = different.shape[1]
    if n < _LEAST_SPEEDS:
        raise IdentificationError(f"comparing networks needs at least {_LEAST_SPEEDS} different speeds, got {n}")
    fold = np.random.default_rng(seed).permutation(n)[visit.ravel()] % _FOLDS
    masks = [fold == k for k in range(_FOLDS)]
    levels = np.empty(0) if points.normal_load is None else np.unique(points.normal_load)
    if 2 < len(levels) <= _MOST_LOADS:
        masks += [points.normal_load == level for level in levels[1:-1]]
    return masks


def _fit_held_out(result: IdentificationResult, left_out: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> _HeldOut:
    rows = np.flatnonzero(left_out)
    inside, outside = result.observations.select(np.flatnonzero(~left_out)), result.observations.select(rows)
    closed = fit_likelihood(result.form, inside, _make_noise(result, ~left_out))
    law = result.form.law(dict(zip(result.parameter_names, np.exp(closed.logs).tolist(), strict=True)))
    fold = replace(result, model=replace(result.model, law=law), observations=inside, rows=inside, optimum=closed)
    predicted, _ = result.form.evaluate(closed.logs, outside)
    squared, network = {WEIGHTS[0]: (outside.magnitude - predicted) ** 2}, fold.network
    for weight in WEIGHTS[1:]:
        network = train_towards(network, fold, closed, inside, weight)
        torque = outside.sign * np.asarray(network.torque(outside.velocity, outside.normal_load))
        squared[weight] = (outside.magnitude - torque) ** 2
    return _HeldOut(rows, squared)


def _make_noise(result: IdentificationResult, rows: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Noise:
    noise = result.optimum.noise
    return noise if noise.deviation is None else Noise(noise.kind, noise.deviation[rows])


def _compute_deviation(result: IdentificationResult) -> FloatArray:
    """Standard deviation of each point [N·m] or [N]. Shape (n_points,)."""
    spread = np.sqrt(result.optimum.noise.variance(result.optimum.whitened.residual, len(result.parameter_names)))
    return np.asarray(spread / result.optimum.whitened.weight)


def _choose(scores: dict[float, FloatArray]) -> float:
    """The largest weight that the data do not refuse; the closed form is refused on stronger evidence only."""
    best = min(scores, key=lambda weight: float(np.mean(scores[weight])))
    for weight in sorted(scores, reverse=True):
        behind = scores[weight] - scores[best]
        allowed = _EVIDENCE if weight == np.inf else 1.0
        if np.mean(behind) <= allowed * np.std(behind) / np.sqrt(len(behind)):
            return weight
    return best


def _describe_choice(chosen: float, held_out: dict[float, float]) -> str:
    closed, driven = held_out[np.inf], held_out[DATA_DRIVEN]
    if chosen == np.inf:
        return (
            f"the closed form is kept: held-out error {closed:.3g} noise deviations, {driven:.3g} for a purely "
            "data-driven network"
        )
    return (
        f"the data depart from the law: held-out error {held_out[chosen]:.3g} noise deviations with the network, "
        f"{closed:.3g} with the closed form, {driven:.3g} with a purely data-driven network"
    )


def train_towards(
    network: TanhNetwork, result: IdentificationResult, closed: Optimum, points: Observations, weight: float
) -> TanhNetwork:
    """Train from `network` on the data and, `weight` times, on the closed form over a wider range.

    Args:
        network: Where to start.
        result: The identification, for scales and the form.
        closed: The closed form that holds the network.
        points: The data.
        weight: Weight of a closed-form point against a data point.
    """
    anchor = _make_anchor(result, closed)
    typical = float(np.median(_compute_deviation(result)))
    velocity = np.concatenate([points.velocity, anchor.velocity])
    load = None
    if points.normal_load is not None and anchor.normal_load is not None:
        load = np.concatenate([points.normal_load, anchor.normal_load])
    target = np.concatenate([points.sign * points.magnitude, anchor.torque]) / network.torque_scale
    importance = np.concatenate([np.ones(points.size), np.full(len(anchor.velocity), np.sqrt(weight))])
    importance *= network.torque_scale / typical
    inputs = network.inputs(velocity, load)
    return train_network(network, inputs, target, importance, TrainingLimits(_ITERATIONS, gain=1e-4, damping=1.0))


def _make_anchor(result: IdentificationResult, closed: Optimum) -> _Anchor:
    points = result.observations
    side = np.geomspace(points.speed.min(), _WIDER * points.speed.max(), _PER_SIDE)
    velocity = np.concatenate([-side[::-1], side])
    loads = None
    if points.normal_load is not None:
        levels = np.unique(np.quantile(points.normal_load, [0.0, 0.5, 1.0]))
        velocity, loads = np.tile(velocity, len(levels)), np.repeat(levels, len(velocity))
    magnitude, _ = result.form.evaluate(closed.logs, list_places(velocity, loads))
    return _Anchor(velocity, loads, np.sign(velocity) * magnitude)
