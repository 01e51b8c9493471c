"""Levenberg-Marquardt pieces shared by the identifying network and the exported one."""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_solve, cholesky

from fricomp.blas import one_blas_thread
from fricomp.laws import FloatArray

from .architecture import LAYER_SIZES, Layer, TanhNetwork, forward_with_jacobian

_STEEP_UNITS = 2
_GAIN = 1.5
_ROUNDING = 1e-14
"""Added to a kernel's diagonal, as a fraction of its trace, so that rounding leaves it positive definite."""


def initial_layers(rng: np.random.Generator, nearest: float, jump: float, *, uses_load: bool) -> tuple[Layer, ...]:
    """Random layers that can bend where friction does.

    Two units of the first layer are steps at rest, for the change of sign; the others bend at speeds
    spaced logarithmically over both directions, each over about its own speed. The rest is random.

    Args:
        rng: Source of the random weights.
        nearest: Lowest scaled speed at which a unit bends.
        jump: Scaled speed within which the torque changes its sign.
        uses_load: Whether the normal load varies; else its weights are zero, so that no load can mislead.
    """
    layers = [
        Layer(rng.normal(0.0, _GAIN / np.sqrt(n_in), (n_out, n_in)), rng.normal(0.0, 0.3 * _GAIN, n_out))
        for n_in, n_out in pairwise(LAYER_SIZES)
    ]
    n_side = (LAYER_SIZES[1] - _STEEP_UNITS) // 2
    bends = np.geomspace(nearest, 1.0, n_side)
    centre = np.concatenate([bends, -bends]) * np.exp(rng.normal(0.0, 0.1, 2 * n_side))
    centre = np.concatenate([[0.25 * jump, -0.25 * jump], centre])
    slope = np.concatenate([[8.0 / jump] * _STEEP_UNITS, 1.5 / np.abs(centre[_STEEP_UNITS:])])
    load_weight = layers[0].weight[:, 1] * float(uses_load)
    load_weight[:_STEEP_UNITS] = 0.0
    layers[0] = Layer(np.stack([slope, load_weight], axis=1), -slope * centre)
    return tuple(layers)


def solve_output_layer(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Change of the output layer that fits best, a linear problem. Shape (n_weights,), zero elsewhere."""
    n_out = LAYER_SIZES[-2] + 1
    ridge = 1e-4 * np.eye(n_out)
    step, *_ = np.linalg.lstsq(
        np.concatenate([jacobian[:, -n_out:], ridge]), -np.concatenate([residual, np.zeros(n_out)]), rcond=None
    )
    change = np.zeros(jacobian.shape[1])
    change[-n_out:] = step
    return change


@dataclass
class Damping:
    """Levenberg's lambda, steered by how well the linear model predicted the gain [nielsen1999damping]."""

    value: float = 1e-2
    growth: float = 2.0

    def accept(self, gain_ratio: float) -> None:
        """Shrink after a step that was taken."""
        self.value = max(self.value * max(0.2, 1.0 - (2.0 * min(gain_ratio, 2.0) - 1.0) ** 3), 1e-14)
        self.growth = 2.0

    def reject(self) -> None:
        """Grow after a step that was refused."""
        self.value *= self.growth
        self.growth *= 2.0


def damped_kernel(jacobian: FloatArray, damping: float) -> FloatArray:
    """Lower Cholesky factor of I + J J'/damping: fewer rows than weights make this the small system."""
    kernel = jacobian @ jacobian.T / damping
    kernel[np.diag_indices_from(kernel)] += 1.0 + _ROUNDING * float(np.trace(kernel))
    return np.asarray(cholesky(kernel, lower=True, overwrite_a=True, check_finite=False))


def damped_step(jacobian: FloatArray, factor: FloatArray, residual: FloatArray, damping: float) -> FloatArray:
    """Minimiser of |J p + r|^2 + damping |p|^2. Shape (n_weights,)."""
    return np.asarray(-jacobian.T @ cho_solve((factor, True), residual, check_finite=False) / damping)


class TrainingLimits(NamedTuple):
    """When a training ends.

    Attributes:
        iterations: Most steps to try.
        residual: Ends when no residual is larger.
        gain: Ends when a step lowers the sum of squares by less than this fraction.
        damping: Damping of the first step.
    """

    iterations: int
    residual: float = 0.0
    gain: float = 0.0
    damping: float = 1e-2


@one_blas_thread()
def train_network(
    network: TanhNetwork, inputs: FloatArray, target: FloatArray, importance: FloatArray, limits: TrainingLimits
) -> TanhNetwork:
    """Levenberg-Marquardt on the weighted squares of output minus target.

    Args:
        network: Where to start.
        inputs: Scaled inputs. Shape (n_points, 2).
        target: Scaled torque. Shape (n_points,).
        importance: Factor on each residual. Shape (n_points,).
        limits: When to end.
    """

    def evaluate(weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        output, jacobian = forward_with_jacobian(network.with_parameters(weights).layers, inputs)
        return importance * (output - target), importance[:, None] * jacobian

    weights, damping = network.parameters(), Damping(limits.damping)
    residual, jacobian = evaluate(weights)
    for _ in range(limits.iterations):
        change = damped_step(jacobian, damped_kernel(jacobian, damping.value), residual, damping.value)
        linear = residual + jacobian @ change
        trial, trial_jacobian = evaluate(weights + change)
        before, after = float(residual @ residual), float(trial @ trial)
        if not after < before:
            damping.reject()
            continue
        damping.accept((before - after) / max(before - float(linear @ linear), 1e-300))
        weights, residual, jacobian = weights + change, trial, trial_jacobian
        if before - after < limits.gain * before or np.max(np.abs(residual)) < limits.residual:
            break
    return network.with_parameters(weights)
