r"""The noise of friction points, and the likelihood it makes.

Absolute noise has one standard deviation s; relative noise has s times the *model's* magnitude m(theta). Weights
taken from the data (1/|y|) would favour points that happen to lie low and bias every parameter. The level s is
unknown and profiled out: with e = y - m the negative log-likelihood is

    n/2 (log(2 pi / n sum r_i^2) + 1),   r = e (absolute),   r = e G/m (relative),   G = exp(mean log m)

so that maximum likelihood, determinant included, *is* nonlinear least squares in r [seber2003nonlinear].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from .observation import Observations

NoiseKind = Literal["relative", "absolute", "given"]
_LEAST_SPREAD = 1e-14
"""Residuals below this fraction of the torque are rounding; a likelihood is not computed from them."""


class Whitened(NamedTuple):
    """Residuals of equal variance.

    Attributes:
        residual: r(theta), times the root of how many points a row stands for. Shape (n_points,).
        jacobian: dr/dlog(theta). Shape (n_points, n_parameters).
        weight: What a torque error is multiplied by. Shape (n_points,).
    """

    residual: FloatArray
    jacobian: FloatArray
    weight: FloatArray


@dataclass(frozen=True)
class Noise:
    """A noise model.

    Attributes:
        kind: `relative`, `absolute` (both with unknown level) or `given`.
        deviation: Standard deviation of each point [N·m] or [N] where `given`. Shape (n_points,).
        count: How many measured points each stands for; None for one. Shape (n_points,).
    """

    kind: NoiseKind
    deviation: FloatArray | None = None
    count: FloatArray | None = None

    def counting(self, points: Observations) -> Noise:
        """The same noise for rows that stand for several points each; one deviation is that of each point."""
        if points.count is None:
            return self
        deviation = None if self.deviation is None else np.full(points.size, self.deviation[0])
        return Noise(self.kind, deviation, points.count)

    def _average(self, values: FloatArray) -> FloatArray:
        """Mean over the measured points."""
        if self.count is None:
            return np.asarray(values.mean(axis=0))
        return np.asarray(np.average(values, axis=0, weights=self.count))

    def _count(self, rows: FloatArray) -> float:
        """Number of measured points."""
        return float(len(rows) if self.count is None else np.sum(self.count))

    def whiten(self, observed: FloatArray, magnitude: FloatArray, jacobian: FloatArray) -> Whitened:
        """Residuals r(theta) whose sum of squares orders parameters as the likelihood does.

        Args:
            observed: y. Shape (n_points,).
            magnitude: m(theta). Shape (n_points,).
            jacobian: dm/dlog(theta). Shape (n_points, n_parameters).
        """
        error, root = observed - magnitude, 1.0 if self.count is None else np.sqrt(self.count)
        if self.kind == "relative":
            relative = jacobian / magnitude[:, None]
            weight = root * np.exp(self._average(np.log(magnitude))) / magnitude
            slope = weight[:, None] * (self._average(relative) - relative)
            return Whitened(weight * error, slope * error[:, None] - weight[:, None] * jacobian, weight)
        weight = root * (np.ones_like(observed) if self.deviation is None else 1.0 / self.deviation)
        return Whitened(weight * error, -weight[:, None] * jacobian, weight)

    def negative_log_likelihood(self, residual: FloatArray, torque_scale: float) -> float:
        """Of whitened residuals, the unknown level at its optimum.

        Args:
            residual: Shape (n_points,).
            torque_scale: Largest torque [N·m] or [N].
        """
        n = self._count(residual)
        if self.deviation is not None:
            units = n * float(self._average(np.log(self.deviation)))
            return float(0.5 * residual @ residual + units + 0.5 * n * np.log(2.0 * np.pi))
        spread = max(float(residual @ residual) / n, (_LEAST_SPREAD * torque_scale) ** 2)
        return float(0.5 * n * (np.log(2.0 * np.pi * spread) + 1.0))

    def variance(self, residual: FloatArray, n_parameters: int) -> float:
        """Unbiased variance of the whitened residuals; 1 where the deviations were given."""
        if self.deviation is not None:
            return 1.0
        return float(residual @ residual) / max(self._count(residual) - n_parameters, 1)

    def information(self, whitened: Whitened, magnitude: FloatArray, jacobian: FloatArray) -> FloatArray:
        """Fisher information about log(theta), the unknown level eliminated. Shape (n_parameters, n_parameters).

        With relative noise the spread of the points tells about m too: 2 sum (q - mean q)(q - mean q)', q = dlog m.
        """
        n = whitened.jacobian.shape[1]
        scaled = whitened.weight[:, None] * jacobian
        information = scaled.T @ scaled / max(self.variance(whitened.residual, n), 1e-300)
        if self.kind == "relative":
            q = jacobian / magnitude[:, None]
            centred = q - self._average(q)
            centred = centred if self.count is None else centred * np.sqrt(self.count)[:, None]
            information = information + 2.0 * centred.T @ centred
        return np.asarray(information)


def parse_noise(noise: str | ArrayLike, kept: np.ndarray[tuple[int], np.dtype[np.intp]], total: int) -> list[Noise]:
    """Candidates for the noise model.

    Args:
        noise: `auto`, `relative`, `absolute`, or one standard deviation for each point given [N·m] or [N].
        kept: Positions of the points used.
        total: Number of points given.

    Raises:
        IdentificationError: `noise` is none of these.
    """
    if isinstance(noise, str):
        candidates: dict[str, list[Noise]] = {
            "auto": [Noise("relative"), Noise("absolute")],
            "relative": [Noise("relative")],
            "absolute": [Noise("absolute")],
        }
        if noise not in candidates:
            raise IdentificationError(
                f"unknown noise {noise!r}; use {', '.join(candidates)} or an array of standard deviations"
            )
        return candidates[noise]
    deviation = np.broadcast_to(np.asarray(noise, dtype=np.float64), (total,)) if np.ndim(noise) == 0 else noise
    given = np.asarray(deviation, dtype=np.float64).ravel()
    if len(given) != total or not np.all(np.isfinite(given)) or np.any(given <= 0.0):
        raise IdentificationError(
            f"noise must be {total} positive standard deviations, one a point; got {len(given)} values, "
            f"the smallest {np.min(given, initial=np.inf):g}"
        )
    return [Noise("given", given[kept])]
