"""The exported network: trained to a torque function on a grid of its own, not to noisy points."""

from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np

from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .architecture import Layer, TanhNetwork, forward, forward_with_jacobian
from .training import TrainingLimits, initial_layers, solve_output_layer, train_network

__all__ = ["Distillation", "TorqueFunction", "collocation_grid", "distil", "single_precision_error"]

TorqueFunction = Callable[[FloatArray, FloatArray | None], FloatArray]

JUMP = 1e-4
"""Scaled speed within which an exported network changes its sign at rest."""
_WANTED = 1e-4
"""Largest deviation from the function, as a fraction of the largest torque, at which training stops."""
_ALLOWED_ERROR = 5e-4
_ALLOWED_ERROR_OVER_LOADS = 0.02
"""Largest deviation with which a network is taken; the product of sign and load is harder to represent."""
_ALLOWED_ROUNDING = 1.0e-6
"""Largest error of single precision, as a fraction of the largest torque, with which a network is taken."""
_ATTEMPTS = 4


class Distillation(NamedTuple):
    """A network beside the function it was trained to.

    Attributes:
        network: The network.
        largest_error: Largest deviation on a grid between the training points, fraction of the largest torque.
        rms_error: Root mean square deviation there, likewise.
        rounding: Largest difference between single and double precision there, likewise.
    """

    network: TanhNetwork
    largest_error: float
    rms_error: float
    rounding: float


class _Grid(NamedTuple):
    velocity: FloatArray
    normal_load: FloatArray | None


def collocation_grid(top: float, loads: tuple[float, float] | None, per_side: int, shift: float = 0.0) -> _Grid:
    """Speeds on both sides, spaced by their logarithm and evenly, and rest; over every load of a few.

    Args:
        top: Highest speed [rad/s] or [m/s].
        loads: Lowest and highest normal load, or None.
        per_side: Speeds a side.
        shift: Moves the points by this fraction of their spacing, to check between them.
    """
    low = np.geomspace(JUMP, 1.0, per_side // 2)
    even = np.linspace(1.0 / per_side, 1.0, per_side - per_side // 2)
    low = low[:-1] * (low[1:] / low[:-1]) ** shift
    even = even[:-1] + shift * np.diff(even)
    side = top * np.concatenate([low, even, [1.0]])
    velocity = np.concatenate([-side[::-1], [0.0], side])
    if loads is None:
        return _Grid(velocity, None)
    levels = np.linspace(*loads, 5 if shift == 0.0 else 4)
    return _Grid(np.tile(velocity, len(levels)), np.repeat(levels, len(velocity)))


def distil(
    function: TorqueFunction, top: float, loads: tuple[float, float] | None = None, *, bend: float, seed: int = 0
) -> Distillation:
    """Train the paper's network to `function` over speeds up to `top` and the range of loads.

    Args:
        function: Torque [N·m] or [N] of (velocity, normal load).
        top: Highest speed [rad/s] or [m/s].
        loads: Lowest and highest normal load, or None where the function does not use it.
        bend: Scaled speed at which the function starts to bend.
        seed: Seed of the first weights.

    Returns:
        The best of a few attempts; the first that is exact enough in single precision too ends the search.
    """
    best: Distillation | None = None
    for attempt in range(_ATTEMPTS):
        result = _try_once(function, top, loads, bend, np.random.default_rng([seed, attempt]))
        if best is None or _measure_badness(result, loads) < _measure_badness(best, loads):
            best = result
        if _measure_badness(best, loads) <= 1.0:
            break
    assert best is not None
    return best


def _measure_badness(result: Distillation, loads: tuple[float, float] | None) -> float:
    """Above 1 where another attempt is worth its time."""
    allowed = _ALLOWED_ERROR if loads is None else _ALLOWED_ERROR_OVER_LOADS
    return max(result.largest_error / allowed, result.rounding / _ALLOWED_ROUNDING)


def _try_once(
    function: TorqueFunction, top: float, loads: tuple[float, float] | None, bend: float, rng: np.random.Generator
) -> Distillation:
    grid = collocation_grid(top, loads, 160 if loads is None else 50)
    target = function(*grid)
    scale = float(np.max(np.abs(target))) or 1.0
    offset, half = (1.0, 1.0) if loads is None else (sum(loads) / 2.0, max((loads[1] - loads[0]) / 2.0, 1e-9))
    layers = initial_layers(rng, float(np.clip(bend, 1e-3, 0.2)), JUMP, uses_load=loads is not None)
    network = TanhNetwork(layers, top, scale, offset, float(half))
    network = _fit(network, network.inputs(*grid), target / scale, 100 if loads is None else 200)
    check = collocation_grid(top, loads, 400 if loads is None else 120, shift=0.5)
    moving = check.velocity != 0.0
    error = (np.asarray(network.torque(*check)) - function(*check))[moving] / scale
    rounding = single_precision_error(network, *check) / scale
    return Distillation(network, float(np.max(np.abs(error))), compute_rms(error), rounding)


def _fit(network: TanhNetwork, inputs: FloatArray, target: FloatArray, iterations: int) -> TanhNetwork:
    """The output layer by linear least squares first, then everything."""
    output, jacobian = forward_with_jacobian(network.layers, inputs)
    network = network.with_parameters(network.parameters() + solve_output_layer(jacobian, output - target))
    limits = TrainingLimits(iterations, residual=_WANTED)
    return train_network(network, inputs, target, np.ones(len(target)), limits)


def single_precision_error(network: TanhNetwork, velocity: FloatArray, normal_load: FloatArray | None) -> float:
    """Largest torque difference [N·m] or [N] when weights and arithmetic are single precision."""
    v32 = velocity.astype(np.float32).astype(np.float64)
    load32 = None if normal_load is None else normal_load.astype(np.float32).astype(np.float64)
    inputs = network.inputs(v32, load32)
    single: Any = [(layer.weight.astype(np.float32), layer.bias.astype(np.float32)) for layer in network.layers]
    rounded = forward([Layer(*parts) for parts in single], cast(Any, inputs.astype(np.float32)))
    return float(np.max(np.abs(network.torque_scale * (rounded - forward(network.layers, inputs)))))
