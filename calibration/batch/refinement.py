"""Levenberg-Marquardt on the logarithms of the parameters, for many starts at once [more1978levenberg]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .likelihood import BatchNoise, Linearised, compute_bounded_curve, linearise
from .points import PointBatch

if TYPE_CHECKING:
    import torch

_ITERATIONS = 300
_STEP = 1e-10  # of a logarithm: smaller ones end a search
_DROP = 1e-13  # relative fall of the cost that counts as none
_VANISHED = 10.0  # a parameter whose logarithm falls by more than this is gone
_LARGEST_LOG = 60.0  # no friction parameter lies beyond e^60
_FIRST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e10


@dataclass(frozen=True)
class _State:
    """Where the searches stand; each tensor has a leading axis of starts."""

    logs: torch.Tensor
    at: Linearised
    damping: torch.Tensor
    scale: torch.Tensor

    def select(self, index: torch.Tensor) -> _State:
        at = Linearised(*(values[index] for values in self.at))
        return _State(self.logs[index], at, self.damping[index], self.scale[index])


def refine_all(logs: torch.Tensor, points: PointBatch, noise: BatchNoise) -> torch.Tensor:
    """The local optimum that each start leads to; searches that have ended leave the batch.

    Args:
        logs: Starts. Shape (n_starts, 8).
        points: Of each start, in the same order.
        noise: Noise model.

    Returns:
        Logarithms at the optima, within their bounds. Shape (n_starts, 8).
    """
    import torch

    found = _descend(logs, points, noise)
    vanished = found < logs - _VANISHED
    again = torch.nonzero(vanished.any(dim=1))[:, 0]
    if len(again):
        # A long step may have taken it so far, and the logarithm of nothing has no slope to come back by.
        found[again] = _descend(torch.where(vanished, logs, found)[again], points.select(again), noise)
    return torch.minimum(found, points.upper_logs)


def _descend(logs: torch.Tensor, points: PointBatch, noise: BatchNoise) -> torch.Tensor:
    import torch

    found = logs.clone()
    going = torch.arange(len(logs), device=logs.device)
    state = _begin(logs, points, noise)
    for _ in range(_ITERATIONS):
        state, ended = _step(state, points, noise)
        found[going[ended]] = state.logs[ended]
        if bool(ended.any()):
            kept = torch.nonzero(~ended)[:, 0]
            going, state, points = going[kept], state.select(kept), points.select(kept)
        if not len(going):
            break
    found[going] = state.logs
    return found


def _get_diagonal(normal: torch.Tensor) -> torch.Tensor:
    return normal.diagonal(dim1=1, dim2=2).clamp(min=1e-300).sqrt()


def _begin(logs: torch.Tensor, points: PointBatch, noise: BatchNoise) -> _State:
    import torch

    at = linearise(compute_bounded_curve(logs, points), points, noise)
    return _State(logs, at, torch.full_like(at.cost, _FIRST_DAMPING), _get_diagonal(at.normal))


def _step(state: _State, points: PointBatch, noise: BatchNoise) -> tuple[_State, torch.Tensor]:
    """One damped Gauss-Newton step where it lowers the cost, more damping where not; and which searches ended."""
    import torch

    before = state.at
    scaled = before.normal / (state.scale[:, :, None] * state.scale[:, None, :])
    damped = scaled + torch.diag_embed(state.damping[:, None].expand_as(state.logs))
    solution, info = torch.linalg.solve_ex(damped, -before.gradient / state.scale)
    change = torch.nan_to_num(solution / state.scale, nan=0.0, posinf=0.0, neginf=0.0)
    logs = (state.logs + change).clamp(-_LARGEST_LOG, _LARGEST_LOG)
    there = linearise(compute_bounded_curve(logs, points), points, noise)
    better = (there.cost < before.cost) & (info == 0)
    still = (change.abs().amax(dim=1) < _STEP) | (better & (before.cost - there.cost <= _DROP * before.cost))
    vector, matrix = better[:, None], better[:, None, None]
    after = Linearised(
        torch.where(better, there.cost, before.cost),
        torch.where(matrix, there.normal, before.normal),
        torch.where(vector, there.gradient, before.gradient),
    )
    damping = torch.where(better, state.damping * 0.1, state.damping * 5.0).clamp(min=1e-14)
    scale = torch.where(vector, torch.maximum(state.scale, _get_diagonal(there.normal)), state.scale)
    return _State(torch.where(vector, logs, state.logs), after, damping, scale), still | (damping > _LARGEST_DAMPING)
