"""The paper's own training: the same network and losses, 50,000 Adam steps in torch, learning rate 0.001."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from fricomp.errors import MissingExtraError

from .comparators import Comparison, population_likelihood
from .problem import Draw

__all__ = ["STEPS", "run_adam"]

STEPS = 50_000
_RATE = 1e-3
_START = 0.1
"""First value of all eight parameters; the paper gives none."""


def run_adam(draw: Draw, seed: int, steps: int = STEPS) -> Comparison:
    """Train network and parameters together by gradient descent, unweighted losses as in equations (4) to (6).

    Raises:
        MissingExtraError: torch is not installed.
    """
    try:
        import torch
    except ImportError:
        raise MissingExtraError("torch", "calibrate") from None
    torch.manual_seed(seed)
    points = draw.points
    velocity = torch.tensor(points.velocity)
    measured = torch.tensor(points.magnitude * points.sign)
    inputs = torch.stack([velocity, torch.ones_like(velocity)], dim=1)
    widths = (2, 20, 20, 20)
    hidden = [m for a, b in pairwise(widths) for m in (torch.nn.Linear(a, b), torch.nn.Tanh())]
    network = torch.nn.Sequential(*hidden, torch.nn.Linear(20, 1)).double()
    parameters = torch.full((8,), _START, dtype=torch.float64, requires_grad=True)
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
