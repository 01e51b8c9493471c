"""Where to start: variable projection over a grid of Stribeck velocities, for many joints at once.

At a fixed Stribeck velocity a direction is linear in its other three parameters, whose best positive values are those
of one of the seven sets of columns that may be left in [golub1973variable]. A scan of the velocity sees every basin.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from .likelihood import BatchNoise, compute_curve
from .points import BRANCH, PointBatch

if TYPE_CHECKING:
    import torch

_GRID = 48
_SMALLEST = 1e-3
"""A linear parameter that projection puts at zero starts at this fraction of its column's scale."""
_SUBSETS = tuple(kept for size in (1, 2, 3) for kept in combinations(range(3), size))


class Basins(NamedTuple):
    """The best basin and, where there is one, the second best of each direction.

    Attributes:
        forward: Logarithms of the parameters. Shape (n_joints, 2, 4).
        forward_known: Whether there is a second one. Shape (n_joints,).
        reverse: As `forward`.
        reverse_known: As `forward_known`.
    """

    forward: torch.Tensor
    forward_known: torch.Tensor
    reverse: torch.Tensor
    reverse_known: torch.Tensor


class Starts(NamedTuple):
    """Starting points, the best of each joint among them.

    Attributes:
        joint: Which joint each belongs to. Shape (n_starts,).
        logs: Logarithms of the parameters. Shape (n_starts, 8).
    """

    joint: torch.Tensor
    logs: torch.Tensor


def scan_basins(points: PointBatch, weight: torch.Tensor) -> Basins:
    """The two best basins of each direction.

    Args:
        points: Of the joints.
        weight: Of each point; 0 where padded. Shape (n_joints, 2, n_points).
    """
    return Basins(*_scan(points, weight, 0), *_scan(points, weight, 1))


def find_starts(points: PointBatch, plain: Basins, noise: BatchNoise) -> Starts:
    """Up to three starts a joint: both directions in their best basin, and either in its second one.

    Args:
        points: Of the joints.
        plain: Basins without weights.
        noise: Noise model; `relative` looks for the basins again, weighted by the best curve so far.
    """
    import torch

    basins = plain
    if noise == "relative":
        best = torch.cat([plain.forward[:, 0], plain.reverse[:, 0]], dim=1)
        floor = 1e-3 * points.torque_scale[:, None, None]
        weight = points.given / torch.maximum(compute_curve(best, points).magnitude, floor)
        basins = scan_basins(points, weight)
    forward, forward_known, reverse, reverse_known = basins
    every = torch.arange(len(forward), device=forward.device)
    chosen = [(every, 0, 0), (every[forward_known], 1, 0), (every[reverse_known], 0, 1)]
    return Starts(
        torch.cat([rows for rows, _, _ in chosen]),
        torch.cat([torch.cat([forward[rows, a], reverse[rows, b]], dim=1) for rows, a, b in chosen]),
    )


def _scan(points: PointBatch, weight: torch.Tensor, side: int) -> tuple[torch.Tensor, torch.Tensor]:
    """The two best basins of one direction, forward (0) or reverse (1).

    Returns:
        Logarithms of the parameters, shape (n_joints, 2, 4), and whether there is a second basin, shape (n_joints,).
    """
    import torch

    speed, inside = points.speed[:, side], points.given[:, side] > 0.0
    lowest = torch.where(inside, speed, torch.inf).amin(dim=1)
    highest = torch.where(inside, speed, 0.0).amax(dim=1)
    ramp = torch.linspace(0.0, 1.0, _GRID, dtype=torch.float64, device=speed.device)
    low, high = torch.log(lowest / 3.0), torch.log(2.0 * highest)
    shape = torch.exp(low[:, None] + (high - low)[:, None] * ramp)
    logs, cost = _project(speed, points.magnitude[:, side], weight[:, side] ** 2, shape)
    edge = torch.full_like(cost[:, :1], torch.inf)
    padded = torch.cat([edge, cost, edge], dim=1)
    valley = (cost <= padded[:, :-2]) & (cost <= padded[:, 2:])
    depth, place = torch.where(valley, cost, torch.inf).topk(2, dim=1, largest=False)
    return torch.gather(logs, 1, place[:, :, None].expand(-1, -1, BRANCH)), torch.isfinite(depth[:, 1])


def _project(
    s: torch.Tensor, y: torch.Tensor, w2: torch.Tensor, shape: torch.Tensor
) -> tuple[torch.Tensor, torch.Tensor]:
    """Best positive linear parameters at each Stribeck velocity, and the squared residual they leave.

    Args:
        s: Speeds. Shape (n_joints, n_points).
        y: Magnitudes. Shape (n_joints, n_points).
        w2: Squared weights. Shape (n_joints, n_points).
        shape: Stribeck velocities. Shape (n_joints, n_grid).
    """
    import torch

    g = torch.exp(-((s[:, None, :] / shape[:, :, None]) ** 2))
    by_g = g @ torch.stack([w2, w2 * s, w2 * y], dim=2)  # (n_joints, n_grid, 3)
    gg = (g * g @ w2[:, :, None])[..., 0]
    g0, gs, gy = by_g.unbind(dim=2)
    one, ss, sum_s, sum_y, sy, yy = (
        v.sum(dim=1, keepdim=True) for v in (w2, w2 * s * s, w2 * s, w2 * y, w2 * s * y, w2 * y * y)
    )
    fallen = (one - 2.0 * g0 + gg, g0 - gg, sum_s - gs)  # products of 1 - g with the three columns
    rows = (fallen, (fallen[1], gg, gs), (fallen[2], gs, ss.expand_as(gs)))
    gram = torch.stack([torch.stack(row, dim=2) for row in rows], dim=2)
    target = torch.stack([sum_y - gy, gy, sy.expand_as(gy)], dim=2)
    scale = torch.sqrt(torch.diagonal(gram, dim1=2, dim2=3).clamp(min=0.0)).clamp(min=1e-12)
    linear, gain = _solve_nonnegative(gram / (scale[..., :, None] * scale[..., None, :]), target / scale)
    floor = (_SMALLEST * torch.sqrt(yy) + 1e-12)[:, :, None]
    coulomb, static, viscous = (torch.maximum(linear, floor) / scale).unbind(dim=2)
    return torch.log(torch.stack([coulomb, static, shape, viscous], dim=2)), yy - gain


def _solve_nonnegative(gram: torch.Tensor, target: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Non-negative least squares with three columns, by trying every set of columns."""
    import torch

    best, gain = torch.zeros_like(target), torch.zeros_like(target[..., 0])
    for kept in _SUBSETS:
        index = torch.tensor(kept, device=gram.device)
        inner = gram.index_select(-1, index).index_select(-2, index)
        wanted = target.index_select(-1, index)
        solution, info = torch.linalg.solve_ex(inner, wanted)
        explained = (solution * wanted).sum(dim=-1)
        better = (info == 0) & (solution > 0.0).all(dim=-1) & (explained > gain)
        full = torch.zeros_like(target).index_copy(-1, index, solution)
        best, gain = torch.where(better[..., None], full, best), torch.where(better, explained, gain)
    return best, gain
