"""The network of [luo2024pinn], table II: 2-20-20-20-1 with tanh, in float64."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray, Scalar

LAYER_SIZES = (2, 20, 20, 20, 1)


class Layer(NamedTuple):
    """One affine layer.

    Attributes:
        weight: Shape (n_out, n_in).
        bias: Shape (n_out,).
    """

    weight: FloatArray
    bias: FloatArray


@dataclass(frozen=True)
class TanhNetwork:
    """Friction torque over velocity and normal load, normalisation included.

    torque = torque_scale * net(velocity / velocity_scale, (normal_load - load_offset) / load_scale)

    Attributes:
        layers: Affine layers with tanh between them.
        velocity_scale: [rad/s] or [m/s].
        torque_scale: [N·m] or [N].
        load_offset: In the unit of the normal load; also the load assumed where none is given.
        load_scale: In the unit of the normal load.
    """

    layers: tuple[Layer, ...]
    velocity_scale: float
    torque_scale: float
    load_offset: float = 1.0
    load_scale: float = 1.0

    def inputs(self, velocity: Scalar, normal_load: Scalar | None = None) -> FloatArray:
        """Scaled inputs. Shape (n_points, 2)."""
        v = np.atleast_1d(np.asarray(velocity, dtype=np.float64))
        load = np.broadcast_to(self.load_offset if normal_load is None else np.asarray(normal_load), v.shape)
        return np.stack([v / self.velocity_scale, (load - self.load_offset) / self.load_scale], axis=-1)

    def torque(self, velocity: Scalar, normal_load: Scalar | None = None) -> Scalar:
        """Friction torque [N·m] or [N]: a float for a float, else the shape of `velocity`."""
        torque = self.torque_scale * forward(self.layers, self.inputs(velocity, normal_load))
        return float(torque[0]) if np.ndim(velocity) == 0 else torque

    def parameters(self) -> FloatArray:
        """All weights and biases in one vector. Shape (n_weights,)."""
        return join_parameters(self.layers)

    def with_parameters(self, values: FloatArray) -> TanhNetwork:
        """This network with other weights and biases. `values` has shape (n_weights,)."""
        return TanhNetwork(
            split_parameters(values), self.velocity_scale, self.torque_scale, self.load_offset, self.load_scale
        )


def join_parameters(layers: Sequence[Layer]) -> FloatArray:
    """Weights and biases of all layers, one after the other. Shape (n_weights,)."""
    return np.concatenate([np.concatenate([layer.weight.ravel(), layer.bias]) for layer in layers])


def split_parameters(values: FloatArray) -> tuple[Layer, ...]:
    """The layers in a vector of shape (n_weights,)."""
    layers, at = [], 0
    for n_in, n_out in pairwise(LAYER_SIZES):
        weight = values[at : at + n_in * n_out].reshape(n_out, n_in)
        bias = values[at + n_in * n_out : at + (n_in + 1) * n_out]
        layers.append(Layer(weight, bias))
        at += (n_in + 1) * n_out
    return tuple(layers)


def forward(layers: Sequence[Layer], inputs: FloatArray) -> FloatArray:
    """Output of the network. `inputs` has shape (n_points, 2), the result (n_points,)."""
    signal = inputs
    for layer in layers[:-1]:
        signal = np.tanh(signal @ layer.weight.T + layer.bias)
    return np.asarray((signal @ layers[-1].weight.T + layers[-1].bias)[:, 0])


def forward_with_jacobian(layers: Sequence[Layer], inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Output and its derivative by all weights and biases, by back-propagation.

    Returns:
        Shapes (n_points,) and (n_points, n_weights).
    """
    signals = [inputs]
    for layer in layers[:-1]:
        signals.append(np.tanh(signals[-1] @ layer.weight.T + layer.bias))
    output = (signals[-1] @ layers[-1].weight.T + layers[-1].bias)[:, 0]
    n, end = len(inputs), sum(layer.weight.size + layer.bias.size for layer in layers)
    jacobian, back = np.empty((n, end)), np.ones((n, 1))
    for depth in range(len(layers) - 1, -1, -1):
        n_out, n_in = layers[depth].weight.shape
        jacobian[:, end - n_out : end] = back
        end -= n_out * (n_in + 1)
        by_weight = jacobian[:, end : end + n_out * n_in].reshape(n, n_out, n_in)
        np.multiply(back[:, :, None], signals[depth][:, None, :], out=by_weight)
        if depth:
            back = (back @ layers[depth].weight) * (1.0 - signals[depth] ** 2)
    return output, jacobian
