"""Waves of torque over the position of a joint: their order is read off what a fit leaves, and moved to where they fit
best.

What is left holds what was not taken in yet, so that its strongest line is beside the order of the wave: over the range
of the joint the two fall out of step, and what comes of that looks like a spring or a bristle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import LOWEST_RIPPLE, TERMS
from ..prior import ArmPrior
from ..row_weights import BoolArray
from ..rows import ArmRows
from .judge import JointJudge

_HIGHEST = 400.0
"""Most waves a radian times 2 pi that are looked for: at 1 rad/s they pass at 64 Hz, beyond what is compared."""

_HIGHEST_ALONG = 2.0 * np.pi / 1e-3
"""The same a metre, of axes that slide: the magnets of their motors and the threads of their screws are further apart
than a millimetre."""

_STEPS = 4.0
"""Orders a resolvable line: between two of them no line is missed by more than a tenth of its power."""

_ROUNDS = 6
"""Of moving an order; each leaves about the square of the distance before."""

_STILL = 0.1
"""Of its standard deviation, by which an order may move and counts as standing still."""


class RippleSearch:
    """Looks for waves in what a fit leaves.

    The filters are symmetric in time, so that the residuals, which passed them, can be compared with waves that did
    not.

    Args:
        rows: Motion.
        rotary: Whether each joint turns.
    """

    def __init__(self, rows: ArmRows, rotary: Sequence[bool]) -> None:
        self._position = rows.compare(lambda q, _, __: q)
        speed = np.median(np.abs(rows.compare(lambda _, v, __: v)), axis=0)
        most = np.where(rotary, _HIGHEST, _HIGHEST_ALONG)
        self._highest = np.minimum(2.0 * np.pi * rows.cutoff / np.maximum(speed, 1e-9), most)

    def find_order(self, joint: int, left: FloatArray, kept: BoolArray | None = None) -> float:
        """Order of the strongest line in the residuals of a joint, or of some of their rows; 0 for no room.

        Args:
            joint: Number of the joint.
            left: Weighted residuals [N·m] or [N]. Shape (n,).
            kept: Rows that count; all by default. Shape (n,).
        """
        rows = slice(None) if kept is None else kept
        return _find_order(self._position[rows, joint], left[rows], float(self._highest[joint]))

    def resolve(self, joint: int) -> float:
        """Difference of two orders that the range of the joint can tell apart."""
        return 2.0 * np.pi / max(float(np.ptp(self._position[:, joint])), 1e-9)


def propose_ripples(rows: ArmRows, equations: ArmEquations, fit: ArmFit) -> ArmEquations:
    """The equations with a wave in the columns of each joint, of the order at which the residuals have most power.

    A wave that the fit has already keeps its order.
    """
    left = fit.residuals(equations) * equations.weights.rows
    search, orders = RippleSearch(rows, fit.arm.rotary), equations.ripple.copy()
    for j, form in enumerate(fit.model.forms):
        if "cogging" not in dict(form.terms):
            orders[j] = search.find_order(j, left[:, j])
    return equations.with_ripple(rows, orders)


def refine_ripples(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> tuple[ArmFit, ArmEquations]:
    """Move the orders of a fit's waves, as long as that makes the recording more probable.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
    """
    for j in (j for j, form in enumerate(fit.model.forms) if "cogging" in form.names):
        for _ in range(_ROUNDS):
            step = _find_step(rows, equations, fit, j)
            if not step:
                break
            orders = equations.ripple.copy()
            orders[j] += step
            moved = equations.with_ripple(rows, orders)
            there = fit_arm(fit.arm, moved, fit.model, prior, fit)
            if there.log_evidence <= fit.log_evidence:
                break
            fit, equations = there, moved
    return fit, equations


def _find_step(rows: ArmRows, equations: ArmEquations, fit: ArmFit, joint: int) -> float:
    """How far the order of a joint's wave is from where it fits best; 0 where that is next to nothing."""
    order, form = float(equations.ripple[joint]), dict(fit.model.forms[joint].terms)
    cosine, sine = (fit.friction(joint)[name] for name in TERMS["cogging"].names(form["cogging"]))

    def slope(position: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
        q = position[:, joint]
        return np.asarray(q * (sine * np.cos(order * q) - cosine * np.sin(order * q)))[:, None]

    judge = JointJudge(equations, fit, joint, fit.residuals(equations)[:, joint])
    found = judge.estimate(rows.compare(slope))
    step, deviation = float(found.values[0]), float(found.deviations[0])
    return step if abs(step) > _STILL * deviation else 0.0


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
    """At even orders, each wave being the one before it times the same turn of every row."""
    wave = left * np.exp(-1j * orders[0] * position)
    turn = np.exp(-1j * (orders[1] - orders[0]) * position) if orders.size > 1 else wave
    power = np.empty(orders.size)
    for k in range(orders.size):
        power[k] = abs(wave.sum())
        wave *= turn
    return power
