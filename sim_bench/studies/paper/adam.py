"""The paper's own training: the same network and losses, 50,000 Adam steps in torch, learning rate 0.001."""

import time
from itertools import pairwise

import numpy as np

from fricomp.extras import needing
from fricomp.laws import FloatArray

from .comparators import Comparison, build_population_likelihood
from .problem import Draw

_RATE = 1e-3
_WIDTHS = (2, 20, 20, 20, 1)


def run_adam(draw: Draw, starts: FloatArray, steps: int) -> list[Comparison]:
    """Train network and parameters together by gradient descent, unweighted losses as in equations (4) to (6).

    Trainings from several starts share nothing but the calls: each has its own network, loss and moments.

    Args:
        draw: The data.
        starts: First values of the parameters, one training a row; the paper gives none. Shape (n, 8).
        steps: 50,000 in the paper.

    Returns:
        One comparison a start, each with an even share of the time.

    Raises:
        MissingExtraError: torch is not installed.
    """
    with needing("torch", "calibrate"):
        import torch
    torch.manual_seed(0)
    torch.set_num_threads(1)  # matrices of a few hundred rows: more threads mostly wait for each other
    points = draw.points
    velocity, measured = torch.tensor(points.velocity), torch.tensor(points.magnitude * points.sign)
    inputs = torch.stack([velocity, torch.ones_like(velocity)], dim=1).expand(len(starts), -1, -1)
    layers = [[torch.nn.Linear(a, b).double() for _ in starts] for a, b in pairwise(_WIDTHS)]
    weights = [torch.stack([one.weight.detach().T for one in layer]).requires_grad_() for layer in layers]
    biases = [torch.stack([one.bias.detach()[None] for one in layer]).requires_grad_() for layer in layers]
    parameters = torch.tensor(starts, dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.Adam([*weights, *biases, parameters], lr=_RATE)
    forward, speed, sign = torch.tensor(points.forward), velocity.abs(), torch.sign(velocity)
    course, losses = [], []
    begun = time.perf_counter()
    for step in range(steps):
        coulomb, static, stribeck, viscous = (
            torch.where(forward, parameters[:, k, None], parameters[:, k + 4, None]) for k in range(4)
        )
        level = coulomb + (static - coulomb) * torch.exp(-((speed / stribeck) ** 2)) + viscous * speed
        signal = inputs
        for weight, bias in zip(weights[:-1], biases[:-1], strict=True):
            signal = torch.tanh(torch.baddbmm(bias, signal, weight))
        predicted = torch.baddbmm(biases[-1], signal, weights[-1])[:, :, 0]
        loss = ((predicted - measured) ** 2).mean(dim=1) + ((predicted - level * sign) ** 2).mean(dim=1)
        optimiser.zero_grad()
        loss.sum().backward()  # type: ignore[no-untyped-call]
        optimiser.step()
        if step % max(1, steps // 200) == 0:
            losses.append(np.column_stack([np.full(len(starts), step), loss.detach().numpy()]))
            course.append(_copy_values(parameters.detach().numpy()))
    seconds = (time.perf_counter() - begun) / len(starts)
    values = _copy_values(parameters.detach().numpy())
    likelihood = build_population_likelihood(draw)(values)
    return [
        Comparison(values[k], float(likelihood[k]), seconds, np.array(losses)[:, k], np.array(course)[:, k])
        for k in range(len(starts))
    ]


def _copy_values(parameters: FloatArray) -> FloatArray:
    """A copy; v_s enters squared, and its sign says nothing."""
    values = parameters.copy()
    values[:, [2, 6]] = np.abs(values[:, [2, 6]])
    return values
