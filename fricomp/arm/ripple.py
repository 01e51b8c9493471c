"""Waves of torque over the position of a joint: their order is read off what a fit leaves."""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray

from .equations import ArmEquations
from .fit import ArmFit
from .friction import LOWEST_RIPPLE
from .rows import ArmRows

__all__ = ["propose_ripples"]

_HIGHEST = 400.0
"""Most waves a radian times 2 pi that are looked for: at 1 rad/s they pass at 64 Hz, beyond what is compared."""

_STEPS = 4.0
"""Orders a resolvable line: between two of them no line is missed by more than a tenth of its power."""


def propose_ripples(rows: ArmRows, equations: ArmEquations, fit: ArmFit) -> ArmEquations:
    """The equations with a wave in the columns of each joint, of the order at which the residuals have most power.

    A wave that the fit has already keeps its order. The filters are symmetric in time, so that the residuals, which
    passed them, can be compared with waves that did not.
    """
    left = fit.residuals(equations) * equations.weights.rows
    position = rows.compare(lambda q, _, __: q)
    speed = np.abs(rows.compare(lambda _, v, __: v))
    orders = equations.ripple.copy()
    for j, form in enumerate(fit.model.forms):
        if "cogging" not in dict(form.terms):
            highest = 2.0 * np.pi * rows.cutoff / max(float(np.median(speed[:, j])), 1e-9)
            orders[j] = _find_order(position[:, j], left[:, j], min(highest, _HIGHEST))
    return equations.with_ripple(rows, orders)


def _find_order(position: FloatArray, left: FloatArray, highest: float) -> float:
    """Order of the strongest line between those that gravity has and `highest`; 0 where there is no room for one."""
    reach = max(float(np.ptp(position)), 1e-9)
    step = 2.0 * np.pi / reach / _STEPS
    orders = np.arange(max(LOWEST_RIPPLE, 2.0 * np.pi / reach), highest, step)
    if not orders.size:
        return 0.0
    start = float(orders[np.argmax(_measure_power(position, left, orders))])
    fine = start + step * np.linspace(-1.0, 1.0, 21)
    return float(fine[np.argmax(_measure_power(position, left, fine))])


def _measure_power(position: FloatArray, left: FloatArray, orders: FloatArray) -> FloatArray:
    return np.array([abs(left @ np.exp(-1j * order * position)) for order in orders.tolist()])
