"""The likelihood optimum of thousands of draws at once: Gauss-Newton on stacked problems, for the statistics.

Starts at the true values, which `identify` does not know; on draws that both have, the two are compared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .problem import PaperProblem, Reading

__all__ = ["BatchOptima", "batch_optima"]

_ITERATIONS = 40
_CHUNK = 250


class BatchOptima(NamedTuple):
    """Optima of many draws.

    Attributes:
        values: Shape (n_draws, 8).
        deviations: Standard deviations from the Fisher information at the optimum. Shape (n_draws, 8).
    """

    values: FloatArray
    deviations: FloatArray


def batch_optima(reading: Reading, draws: int) -> BatchOptima:
    """Optima of the draws with the seeds 0 to `draws` - 1."""
    chunks = [_chunk(reading, range(at, min(at + _CHUNK, draws))) for at in range(0, draws, _CHUNK)]
    return BatchOptima(*(np.concatenate(parts) for parts in zip(*chunks, strict=True)))


def _chunk(reading: Reading, seeds: range) -> BatchOptima:
    problem = PaperProblem()
    data = [problem.draw(reading, seed) for seed in seeds]
    velocity = data[0].velocity
    moving = velocity != 0.0
    speed, forward = np.abs(velocity[moving]), velocity[moving] > 0.0
    observed = np.stack([draw.torque[moving] for draw in data]) * np.where(forward, 1.0, -1.0)
    logs = np.tile(np.log(problem.true_values), (len(data), 1))
    for _ in range(_ITERATIONS):
        residual, jacobian, _ = _whiten(logs, speed, forward, observed, reading)
        normal = np.einsum("dni,dnj->dij", jacobian, jacobian)
        gradient = np.einsum("dni,dn->di", jacobian, residual)
        logs = logs - np.clip(np.linalg.solve(normal, gradient[:, :, None])[:, :, 0], -0.3, 0.3)
    residual, jacobian, information = _whiten(logs, speed, forward, observed, reading)
    deviations = np.exp(logs) * np.sqrt(np.diagonal(np.linalg.inv(information), axis1=1, axis2=2))
    return BatchOptima(np.exp(logs), deviations)


def _whiten(
    logs: FloatArray,
    speed: FloatArray,
    forward: np.ndarray[tuple[int], np.dtype[np.bool_]],
    observed: FloatArray,
    reading: Reading,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Residuals, their derivative by the logarithms, and the Fisher information of each draw."""
    p = np.exp(logs)[:, :, None]
    model, slopes = np.empty(observed.shape), np.zeros((*observed.shape, 8))
    for rows, at in ((forward, 0), (~forward, 4)):
        s, (fc, fs, vs, fv) = speed[rows], (p[:, at + k] for k in range(4))
        e = np.exp(-((s / vs) ** 2))
        model[:, rows] = fc * (1.0 - e) + fs * e + fv * s
        columns = (fc * (1.0 - e), fs * e, (fs - fc) * e * 2.0 * (s / vs) ** 2, fv * s)
        slopes[:, rows, at : at + 4] = np.stack(columns, axis=-1)
    error, n = observed - model, observed.shape[1]
    if reading == "absolute":
        spread = np.sum(error**2, axis=1) / (n - 8)
        return error, -slopes, np.einsum("dni,dnj->dij", slopes, slopes) / spread[:, None, None]
    q = slopes / model[:, :, None]
    mean = q.mean(axis=1, keepdims=True)
    weight = np.exp(np.mean(np.log(model), axis=1, keepdims=True)) / model
    residual = weight * error
    jacobian = (weight * error)[:, :, None] * (mean - q) - weight[:, :, None] * slopes
    level = np.sum((error / model) ** 2, axis=1) / (n - 8)
    information = np.einsum("dni,dnj->dij", q, q) / level[:, None, None]
    return residual, jacobian, information + 2.0 * np.einsum("dni,dnj->dij", q - mean, q - mean)
