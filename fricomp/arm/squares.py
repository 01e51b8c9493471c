"""The weighted squares of an arm's equations as one quadratic form in what its parameters become in the columns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .coordinates import Coordinates
from .equation_sums import EquationSums
from .equations import ArmEquations
from .rigid.inertia import N_INERTIA


class Linearised(NamedTuple):
    """The weighted squares about some parameters.

    Attributes:
        curvature: Half of it. Shape (size, size).
        pull: Half the downward slope. Shape (size,).
        cost: The squares themselves.
    """

    curvature: FloatArray
    pull: FloatArray
    cost: float


class WeightedSquares:
    """The squares that a model leaves, as they hang on its parameters.

    What the joints share, such as links, enters all of them by the same weights, so that the sums of all joints are
    added up once; each look at them is then a matter of one small matrix.

    Args:
        coordinates: Of the model.
        equations: Of all joints.
    """

    def __init__(self, coordinates: Coordinates, equations: ArmEquations | EquationSums) -> None:
        self._coordinates = coordinates
        self._form = np.zeros((coordinates.size, coordinates.size))
        scale = 1.0 / (equations.weights.noise**2 * equations.weights.inflation)
        for j, (at, taken) in enumerate(coordinates.places_felt):
            self._form[at[:, None], at] += scale[j] * equations.sums[j][taken[:, None], taken]

    def measure(self, x: FloatArray) -> float:
        """Squares at x."""
        v = self._coordinates.weigh(x)
        return float(v @ self._form @ v)

    def linearise(self, x: FloatArray) -> Linearised:
        """Squares and their slopes at x."""
        v, gain = self._coordinates.weigh(x), 1.0 + float(x[-1])
        slope = np.full(v.size, gain)
        slope[-2:] = -1.0, 0.0  # of the delay, which no gain changes, and of the torque
        along = v / gain  # what grows with the gain
        along[-2:] = 0.0
        left, gained = self._form @ v, self._form @ along
        H, g = self._form * slope[:, None] * slope, -slope * left
        H[-1], H[-1, -1], g[-1] = slope * gained, along @ gained, -along @ left
        H[:, -1] = H[-1]
        self._turn_links(H, g, x)
        return Linearised(H, g, float(v @ left))

    def _turn_links(self, H: FloatArray, g: FloatArray, x: FloatArray) -> None:
        """From the inertia of links to their coordinates, in place."""
        n = self._coordinates.n_inertial
        turns = np.swapaxes(self._coordinates.links.jacobian(x[:n].reshape(-1, N_INERTIA)), 1, 2)
        shape = (len(turns), N_INERTIA, -1)
        H[:n] = (turns @ H[:n].reshape(shape)).reshape(n, -1)
        H[:, :n] = (turns @ np.ascontiguousarray(H[:, :n].T).reshape(shape)).reshape(n, -1).T
        g[:n] = (turns @ g[:n].reshape(shape)).ravel()
