"""The maximum-likelihood optimum by other means: variable projection, then Newton on the plain likelihood.

Shares no code with `fricomp.calibration.identification`, so that a mistake there cannot hide here.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares, minimize

from fricomp.laws import FloatArray

from .problem import Draw


class OracleOptimum(NamedTuple):
    """The optimum.

    Attributes:
        values: Parameters in the paper's order. Shape (8,).
        negative_log_likelihood: With the noise level at its optimum.
    """

    values: FloatArray
    negative_log_likelihood: float


def find_optimum(draw: Draw) -> OracleOptimum:
    """Both directions together; with relative noise the noise level couples them."""
    v, tau = draw.velocity[draw.velocity != 0.0], draw.torque[draw.velocity != 0.0]
    sides = [(np.abs(v[side]), np.abs(tau[side])) for side in (v > 0.0, v < 0.0)]
    relative = draw.reading == "relative"
    start = np.concatenate([_project(speed, torque, relative) for speed, torque in sides])
    if not relative:
        error = np.concatenate(
            [y - _compute_curve(s, p)[0] for (s, y), p in zip(sides, np.split(start, 2), strict=True)]
        )
        n = len(error)
        return OracleOptimum(start, 0.5 * n * (np.log(2.0 * np.pi * np.mean(error**2)) + 1.0))

    def objective(scaled: FloatArray) -> tuple[float, FloatArray]:
        return _compute_relative_likelihood(scaled[:8] * start, float(scaled[8]), sides, start)

    spread = np.concatenate(
        [y / _compute_curve(s, p)[0] - 1.0 for (s, y), p in zip(sides, np.split(start, 2), strict=True)]
    )
    begin = np.append(np.ones(8), np.log(np.std(spread)))
    fit = minimize(objective, begin, jac=True, method="BFGS", options={"gtol": 1e-7, "maxiter": 500})
    return OracleOptimum(fit.x[:8] * start, float(fit.fun))


def _compute_curve(speed: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    e = np.exp(-((speed / p[2]) ** 2))
    slope = (p[1] - p[0]) * e * 2.0 * speed**2 / p[2] ** 3
    return p[0] * (1.0 - e) + p[1] * e + p[3] * speed, np.stack([1.0 - e, e, slope, speed])


def _project(speed: FloatArray, torque: FloatArray, relative: bool) -> FloatArray:
    """Variable projection with Levenberg-Marquardt on the Stribeck velocity; weights from the model."""
    weight, best = np.ones_like(speed), np.zeros(4)
    for k in range(6 if relative else 1):

        def linear(log_vs: float, w: FloatArray = weight) -> tuple[FloatArray, FloatArray]:
            e = np.exp(-((speed / np.exp(log_vs)) ** 2))
            columns = np.stack([1.0 - e, e, speed], axis=1) * w[:, None]
            solution, *_ = np.linalg.lstsq(columns, torque * w, rcond=None)
            return np.asarray(solution), np.asarray(columns @ solution - torque * w)

        grid = np.linspace(np.log(0.005), np.log(1.0), 80)
        begin = np.log(best[2]) if k else grid[np.argmin([np.sum(linear(g)[1] ** 2) for g in grid])]
        fit = least_squares(lambda x: linear(x[0])[1], [begin], method="lm", xtol=1e-14, ftol=1e-14)
        fc, fs, fv = linear(fit.x[0])[0]
        best = np.array([fc, fs, np.exp(fit.x[0]), fv])
        if relative:
            weight = 1.0 / _compute_curve(speed, best)[0]
    return best


def _compute_relative_likelihood(
    p: FloatArray, log_level: float, sides: list[tuple[FloatArray, FloatArray]], scale: FloatArray
) -> tuple[float, FloatArray]:
    """-log of the normal densities with standard deviation level * model, and its gradient."""
    value, gradient, level = 0.0, np.zeros(9), np.exp(log_level)
    for k, (speed, torque) in enumerate(sides):
        model, slopes = _compute_curve(speed, p[4 * k : 4 * k + 4])
        z = (torque - model) / (level * model)
        value += float(np.sum(np.log(level * model) + 0.5 * z**2 + 0.5 * np.log(2.0 * np.pi)))
        by_model = 1.0 / model - z * torque / (level * model**2)
        gradient[4 * k : 4 * k + 4] = slopes @ by_model * scale[4 * k : 4 * k + 4]
        gradient[8] += float(np.sum(1.0 - z**2))
    return value, gradient
