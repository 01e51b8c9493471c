r"""Joint training of network and friction parameters, second order, in float64.

The loss of [luo2024pinn] at the data points, weighted by the noise model, is

    sum w_i^2 (N_i - y_i)^2 + sum w_i^2 (N_i - S_i(theta))^2

with the network N, the data y and the closed form S. Turning each pair of residuals by 45 degrees gives

    b_i = w_i (y_i - S_i)/sqrt 2,        a_i = sqrt 2 w_i (N_i - (y_i + S_i)/2)

with the same sum of squares: b holds only friction parameters and is the likelihood itself, a is what the
network has still to learn. A Levenberg-Marquardt step eliminates the network's weights through a system with one
row a point, then solves for the few friction parameters. It follows that the loss with equal weights has its
optimum where weighted least squares has it, as soon as the network can follow the closed form's changes.
"""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg import solve_triangular

from fricomp.blas import one_blas_thread
from fricomp.laws import FloatArray

from ...network import TanhNetwork, forward, forward_with_jacobian
from ...network.training import Damping, damped_kernel, damped_step, initial_layers, solve_output_layer
from .form import SeparableLaw
from .gathering import gather_points
from .likelihood import Noise
from .observation import Observations
from .optimum import Optimum, optimum_at

__all__ = ["StartKind", "Traces", "TrainedPinn", "train_pinn"]

StartKind = Literal["given", "projection", "least_squares"]

_ROOT2 = np.sqrt(2.0)
_MOST_ROWS = 400
"""Rows that the network sees; more points are gathered into about as many means. The likelihood part sees all."""
_LONGEST_STEP = 0.5
"""Largest change of the logarithm of a parameter in one step."""
_SCORE_TOLERANCE = 5e-3
"""Converged within this many standard deviations (Mahalanobis) of the likelihood's own optimum."""
_MOST_STEPS = 150
"""Iterations of a training, refused ones included."""
_SLOW_GAIN = 0.05
"""Training may stop when the loss falls by less than this fraction a step."""


@dataclass(frozen=True)
class Traces:
    """The course of a training, one row an iteration.

    Attributes:
        names: Parameter names.
        parameters: Shape (n_iterations, n_parameters).
        data_loss: Mean squared error of the network to the data, in the unit of the torque squared.
        model_loss: Mean squared error of the network to the closed form, likewise.
        start: Where the parameters started: `given` by the caller, `projection`, or `least_squares`, the likelihood's
            optimum itself, which training then has only to keep.
    """

    names: tuple[str, ...]
    parameters: FloatArray
    data_loss: FloatArray
    model_loss: FloatArray
    start: StartKind = "given"


class TrainedPinn(NamedTuple):
    """What training gives.

    Attributes:
        optimum: The likelihood at the trained parameters.
        network: The network that identified; it follows the noise of the data, and is not the one that is exported.
        traces: Course of the training.
        converged: Whether the score came within tolerance.
        iterations: Steps taken or refused.
    """

    optimum: Optimum
    network: TanhNetwork
    traces: Traces
    converged: bool
    iterations: int


class _Rows(NamedTuple):
    """The network part of the residuals, weights of the points as they were at the last step."""

    error: FloatArray
    by_parameter: FloatArray
    by_weight: FloatArray

    @property
    def cost(self) -> float:
        return float(self.error @ self.error)


class _Problem:
    """The residuals of one training problem, in units of the torque scale."""

    def __init__(self, law: SeparableLaw, observations: Observations, noise: Noise, network: TanhNetwork) -> None:
        self.law, self.observations, self.noise, self.network = law, observations, noise, network
        self.upper = law.upper_logs(observations)
        self.seen, self._noise_seen = _select_rows(observations, noise)
        self.inputs = network.inputs(self.seen.velocity, self.seen.normal_load)
        self._side = self.seen.sign * network.torque_scale

    def optimum(self, logs: FloatArray) -> Optimum:
        return optimum_at(np.minimum(logs, self.upper), self.law, self.observations, self.noise)

    def weigh(self, at: Optimum) -> FloatArray:
        """What an error of the network counts for, at the rows that it sees. Shape (n_seen,)."""
        magnitude, jacobian = self.law.evaluate(at.logs, self.seen)
        return np.asarray(_ROOT2 * self._noise_seen.whiten(self.seen.magnitude, magnitude, jacobian).weight)

    def network_error(self, weights: FloatArray, at: Optimum, weight: FloatArray) -> FloatArray:
        """a alone. The weights of the points are held: they say what a residual is worth, they are no target."""
        output = forward(self.network.with_parameters(weights).layers, self.inputs)
        return np.asarray(
            weight * (output * self._side - self._compute_middle(self.law.evaluate(at.logs, self.seen)[0]))
        )

    def network_rows(self, weights: FloatArray, at: Optimum, weight: FloatArray) -> _Rows:
        """a and its derivatives."""
        output, by_weight = forward_with_jacobian(self.network.with_parameters(weights).layers, self.inputs)
        magnitude, jacobian = self.law.evaluate(at.logs, self.seen)
        return _Rows(
            weight * (output * self._side - self._compute_middle(magnitude)),
            -0.5 * weight[:, None] * jacobian,
            (weight * self._side)[:, None] * by_weight,
        )

    def _compute_middle(self, magnitude: FloatArray) -> FloatArray:
        return 0.5 * (self.seen.magnitude + magnitude)

    def losses(self, weights: FloatArray, at: Optimum) -> tuple[float, float]:
        """Mean squared errors of the network to the data and to the closed form, over the points."""
        output = forward(self.network.with_parameters(weights).layers, self.inputs) * self._side
        closed = self.law.evaluate(at.logs, self.seen)[0]
        errors = (output - self.seen.magnitude) ** 2, (output - closed) ** 2
        data, model = (float(np.average(one, weights=self.seen.count)) for one in errors)
        return data, model


def _select_rows(observations: Observations, noise: Noise) -> tuple[Observations, Noise]:
    """Rows for the network, and their noise: means of neighbours, or every so manieth where deviations differ.

    That step is odd, so that of two rows that stand for one cell either comes up.
    """
    if noise.deviation is None:
        seen = gather_points(observations, most=_MOST_ROWS, spread=False)
        return seen, noise.counting(seen)
    stride = -(-observations.size // _MOST_ROWS) | 1
    rows = np.sort(np.argsort(observations.velocity, kind="stable")[::stride])
    seen = observations.select(rows)
    count = stride * (np.ones(seen.size) if seen.count is None else seen.count)
    return seen.counting(count), replace(noise, deviation=noise.deviation[rows], count=count)


@one_blas_thread()
def train_pinn(law: SeparableLaw, observations: Observations, start: Optimum, *, seed: int) -> TrainedPinn:
    """Train network and parameters together from `start`.

    Args:
        law: Form of the closed form.
        observations: The data.
        start: Where the parameters start, and the noise model.
        seed: Seed of the network's first weights.
    """
    network = untrained_network(observations, np.random.default_rng(seed))
    problem = _Problem(law, observations, start.noise, network)
    weights, at = network.parameters(), start
    rows = problem.network_rows(weights, at, problem.weigh(at) / _compute_residual_unit(at, observations))
    weights = weights + solve_output_layer(rows.by_weight, rows.error)
    return _descend(problem, weights, at)


def untrained_network(observations: Observations, rng: np.random.Generator) -> TanhNetwork:
    """A network scaled to the data, its first units spread over the speeds measured."""
    top, lowest = float(observations.speed.max()), float(observations.speed.min())
    load = observations.normal_load
    offset = 1.0 if load is None else float(np.mean(load))
    half_range = 0.0 if load is None else float(np.ptp(load)) / 2.0
    nearest = max(lowest / top, 1e-3)
    layers = initial_layers(rng, min(nearest, 0.2), 0.5 * nearest, uses_load=half_range > 0.0)
    return TanhNetwork(layers, top, observations.torque_scale, offset, half_range or 1.0)


def _compute_residual_unit(at: Optimum, observations: Observations) -> float:
    """Unit in which residuals are of order one, whatever the torque's is; constant factors change no optimum."""
    return float(np.median(at.whitened.weight)) * observations.torque_scale


def _descend(problem: _Problem, weights: FloatArray, at: Optimum) -> TrainedPinn:
    unit = _compute_residual_unit(at, problem.observations)
    damping, course = Damping(), []
    likelihood = at.whitened.residual / unit / _ROOT2
    weight = problem.weigh(at) / unit
    rows = problem.network_rows(weights, at, weight)
    converged, step_count = False, 0
    for _ in range(_MOST_STEPS):
        step_count += 1
        by_parameter = at.whitened.jacobian / unit / _ROOT2
        change, weight_change, predicted = _solve_joint_step(likelihood, by_parameter, rows, damping.value)
        trial = problem.optimum(at.logs + change)
        trial_likelihood = trial.whitened.residual / unit / _ROOT2
        trial_error = problem.network_error(weights + weight_change, trial, weight)
        before = float(likelihood @ likelihood) + rows.cost
        after = float(trial_likelihood @ trial_likelihood + trial_error @ trial_error)
        if not after < before:
            damping.reject()
            if damping.value > 1e12:
                break
            continue
        damping.accept((before - after) / predicted)
        weights, at, likelihood = weights + weight_change, trial, trial_likelihood
        weight = problem.weigh(at) / unit
        rows = problem.network_rows(weights, at, weight)
        course.append((np.exp(at.logs), *problem.losses(weights, at)))
        converged = _has_converged(at, problem.observations)
        if converged and before - after < _SLOW_GAIN * before:
            break
    return TrainedPinn(
        at, problem.network.with_parameters(weights), _collect_traces(problem.law.names, course), converged, step_count
    )


def _solve_joint_step(
    likelihood: FloatArray, by_parameter: FloatArray, rows: _Rows, damping: float
) -> tuple[FloatArray, FloatArray, float]:
    """Changes of parameters and weights, and the fall of the loss that the linear model promises."""
    factor = damped_kernel(rows.by_weight, damping)
    both = np.column_stack([rows.error, rows.by_parameter])
    reduced = solve_triangular(factor, both, lower=True, check_finite=False)
    J = np.concatenate([by_parameter, reduced[:, 1:]])
    r = np.concatenate([likelihood, reduced[:, 0]])
    normal = J.T @ J
    normal[np.diag_indices_from(normal)] *= 1.0 + damping
    normal[np.diag_indices_from(normal)] += 1e-14 * (1.0 + np.trace(normal))
    change = np.clip(-np.linalg.solve(normal, J.T @ r), -_LONGEST_STEP, _LONGEST_STEP)
    remaining = rows.error + rows.by_parameter @ change
    weight_change = damped_step(rows.by_weight, factor, remaining, damping)
    linear_b = likelihood + by_parameter @ change
    linear_a = remaining + rows.by_weight @ weight_change
    predicted = float(likelihood @ likelihood + rows.cost - linear_b @ linear_b - linear_a @ linear_a)
    return change, weight_change, max(predicted, 1e-300)


def _has_converged(at: Optimum, observations: Observations) -> bool:
    """Whether the score is small, or the closed form meets the data to rounding."""
    exact = at.spread() < 1e-9 * _compute_residual_unit(at, observations)
    return exact or at.score_distance() < _SCORE_TOLERANCE


def _collect_traces(names: tuple[str, ...], course: list[tuple[FloatArray, float, float]]) -> Traces:
    if not course:
        return Traces(names, np.empty((0, len(names))), np.empty(0), np.empty(0))
    parameters, data, model = zip(*course, strict=True)
    return Traces(names, np.array(parameters), np.array(data), np.array(model))
