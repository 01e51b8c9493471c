"""The paper's own training: the same network and losses, 50,000 Adam steps in torch, learning rate 0.001."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from fricomp.errors import MissingExtraError

from .comparators import Comparison, population_likelihood
from .problem import UPPER_BOUNDS, Draw, PaperProblem

__all__ = ["STARTS", "run_adam"]

_RATE = 1e-3
STARTS = {
    "0.1 each": (0.1,) * 8,
    "1 each": (1.0,) * 8,
    "middle of the search bounds": tuple((UPPER_BOUNDS / 2.0).tolist()),
    "true values": PaperProblem().true_values,
}
"""First values of the eight parameters; the paper gives none. The true values are the most generous."""


def run_adam(draw: Draw, start: str, steps: int) -> Comparison:
    """Train network and parameters together by gradient descent, unweighted losses as in equations (4) to (6).

    Args:
        draw: The data.
        start: One of `STARTS`.
        steps: 50,000 in the paper.

    Raises:
        MissingExtraError: torch is not installed.
    """
    try:
        import torch
    except ImportError:
        raise MissingExtraError("torch", "calibrate") from None
    torch.manual_seed(0)
    points = draw.points
    velocity = torch.tensor(points.velocity)
    measured = torch.tensor(points.magnitude * points.sign)
    inputs = torch.stack([velocity, torch.ones_like(velocity)], dim=1)
    widths = (2, 20, 20, 20)
    hidden = [m for a, b in pairwise(widths) for m in (torch.nn.Linear(a, b), torch.nn.Tanh())]
    network = torch.nn.Sequential(*hidden, torch.nn.Linear(20, 1)).double()
    parameters = torch.tensor(STARTS[start], dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.Adam([*network.parameters(), parameters], lr=_RATE)
    forward = torch.tensor(points.forward)
    speed = velocity.abs()
    course, losses = [], []
    begun = time.perf_counter()
    for step in range(steps):
        coulomb, static, stribeck, viscous = (torch.where(forward, parameters[k], parameters[k + 4]) for k in range(4))
        level = coulomb + (static - coulomb) * torch.exp(-((speed / stribeck) ** 2)) + viscous * speed
        predicted = network(inputs)[:, 0]
        loss = ((predicted - measured) ** 2).mean() + ((predicted - level * torch.sign(velocity)) ** 2).mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        if step % max(1, steps // 200) == 0:
            losses.append((step, loss.item()))
            course.append(parameters.detach().numpy().copy())
    seconds = time.perf_counter() - begun
    values = parameters.detach().numpy().copy()
    values[[2, 6]] = np.abs(values[[2, 6]])  # v_s enters squared
    likelihood = float(population_likelihood(draw)(values[None])[0])
    return Comparison("Adam", values, likelihood, seconds, np.array(losses), np.array(course))
