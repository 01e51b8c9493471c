r"""The Stribeck curve of each direction and the likelihood it makes, for many joints at once.

The same closed forms as in `fricomp.calibration.identification` (`form`, `likelihood`), with a leading axis of joints:

    m = f_c (1 - g) + f_s g + f_v |v|,   g = exp(-(v / v_s)^2),   one set of parameters for each direction

A point depends on the four parameters of its own direction only; with relative noise the geometric mean of m couples
the directions, by one outer product.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

from .points import BRANCH, PointBatch

if TYPE_CHECKING:
    import torch

BatchNoise = Literal["relative", "absolute"]
_LEAST_SPREAD = 1e-14
"""Residuals below this fraction of the torque are rounding."""


class Curve(NamedTuple):
    """Friction magnitude and its derivative by the logarithms of the parameters.

    Attributes:
        magnitude: 1 where padded [N·m] or [N]. Shape (n_joints, 2, n_points).
        slopes: By the four parameters of the point's direction; 0 where padded. Shape (n_joints, 2, 4, n_points).
    """

    magnitude: torch.Tensor
    slopes: torch.Tensor


class Linearised(NamedTuple):
    """Residuals of equal variance around one point in parameter space.

    Attributes:
        cost: Their sum of squares, which orders parameters as the likelihood does. Shape (n_joints,).
        normal: Product of their derivative by the logarithms with itself. Shape (n_joints, 8, 8).
        gradient: Half the derivative of the cost. Shape (n_joints, 8).
    """

    cost: torch.Tensor
    normal: torch.Tensor
    gradient: torch.Tensor


def compute_curve(logs: torch.Tensor, points: PointBatch) -> Curve:
    """The closed form at the logarithms of the parameters, shape (n_joints, 8)."""
    import torch

    coulomb, static, stribeck, viscous = torch.exp(logs).view(-1, 2, BRANCH, 1).unbind(dim=2)
    x = (points.speed / stribeck) ** 2
    g = torch.exp(-x) * points.given
    columns = (coulomb * (points.given - g), static * g, (static - coulomb) * 2.0 * x * g)
    slopes = torch.stack([*columns, viscous * points.speed * points.given], dim=2)
    magnitude = slopes[:, :, 0] + slopes[:, :, 1] + slopes[:, :, 3] + (1.0 - points.given)
    return Curve(magnitude, slopes)


def compute_bounded_curve(logs: torch.Tensor, points: PointBatch) -> Curve:
    """`compute_curve` with dry friction held at its upper bound, beyond which a parameter changes nothing."""
    import torch

    upper = points.upper_logs
    curve = compute_curve(torch.minimum(logs, upper), points)
    return curve._replace(slopes=curve.slopes * (logs < upper).view(-1, 2, BRANCH, 1))


def linearise(curve: Curve, points: PointBatch, noise: BatchNoise) -> Linearised:
    """Cost, normal matrix and gradient at a curve."""
    error = (points.magnitude - curve.magnitude) * points.given
    if noise == "absolute":
        return Linearised((error**2).sum(dim=(1, 2)), _multiply_blocks(curve.slopes), -_project(curve.slopes, error))
    count = points.count[:, None]
    mean_log = (curve.magnitude.log() * points.given).sum(dim=(1, 2)) / count[:, 0]
    weight = mean_log.exp()[:, None, None] / curve.magnitude * points.given
    residual = weight * error
    cost = (residual**2).sum(dim=(1, 2))
    relative = curve.slopes / curve.magnitude[:, :, None]
    mean = relative.sum(dim=3).flatten(1) / count
    own = relative * (weight * points.magnitude)[:, :, None]  # the residual's derivative is residual * mean - own
    along = _project(own, residual)
    outer = mean[:, :, None] * along[:, None, :]
    normal = (
        cost[:, None, None] * mean[:, :, None] * mean[:, None, :]
        - outer
        - outer.transpose(1, 2)
        + _multiply_blocks(own)
    )
    return Linearised(cost, normal, cost[:, None] * mean - along)


def _project(columns: torch.Tensor, values: torch.Tensor) -> torch.Tensor:
    """Products of columns with values over the points. Shape (n_joints, 8)."""
    return (columns @ values[:, :, :, None])[..., 0].flatten(1)


def _multiply_blocks(columns: torch.Tensor) -> torch.Tensor:
    """Products of columns with each other, block-diagonal over the directions. Shape (n_joints, 8, 8)."""
    import torch

    inner = columns @ columns.transpose(2, 3)
    nothing = torch.zeros_like(inner[:, 0])
    top, bottom = torch.cat([inner[:, 0], nothing], dim=2), torch.cat([nothing, inner[:, 1]], dim=2)
    return torch.cat([top, bottom], dim=1)


def likelihood_of(cost: torch.Tensor, points: PointBatch) -> torch.Tensor:
    """Negative log-likelihood with the noise level at its optimum. Shape (n_joints,)."""
    import torch

    floor = (_LEAST_SPREAD * points.torque_scale) ** 2
    spread = torch.maximum(cost / points.count, floor)
    return 0.5 * points.count * (torch.log(2.0 * math.pi * spread) + 1.0)


def compute_information(curve: Curve, level: torch.Tensor, points: PointBatch, noise: BatchNoise) -> torch.Tensor:
    """Fisher information about the logarithms, the noise level eliminated. Shape (n_joints, 8, 8).

    Args:
        curve: At the optimum.
        level: Of the noise: of the torque [1], or [N·m] or [N]. Shape (n_joints,).
        points: Of the joints.
        noise: Noise model.
    """
    square = (level**2).clamp(min=1e-300)[:, None, None]
    if noise == "absolute":
        return _multiply_blocks(curve.slopes) / square
    relative = curve.slopes / curve.magnitude[:, :, None]
    products, total = _multiply_blocks(relative), relative.sum(dim=3).flatten(1)
    centred = products - total[:, :, None] * total[:, None, :] / points.count[:, None, None]
    return products / square + 2.0 * centred
