"""The delay of one joint's torque beside the others, moved to where the joint asks for no more of it.

A term of the model is linear in the delay, and the noise of the torque's rate makes it too short: 8 ms came as 6. And
friction that turns round in less than the delay is far from linear in it. So the torque is taken as much earlier as it
is late, and the term is linear about that.
"""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import TERMS
from ..prior import ArmPrior
from ..rows import ArmRows
from .shared_delay import measure_seen

_ROUNDS = 6
_STILL = 0.1
"""Of its standard deviation, below which a delay moves no more."""


def refine_delays(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> tuple[ArmFit, ArmEquations]:
    """Take the torques of joints with a delay of their own as much earlier as they are late.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
    """
    for j in range(len(fit.arm.joints)):
        before, moved = 0.0, 0.0
        for _ in range(_ROUNDS if _find(fit, j) is not None else 0):
            value, deviation = _read(fit, j)
            more = value - float(equations.own_delays[j])
            if abs(more) < _STILL * deviation:
                break
            before, moved = more, more / measure_seen(more, before, moved)
            equations = equations.with_torque(rows, _move(equations.own_delays, j, moved))
            fit = fit_arm(fit.arm, equations, fit.model, prior, fit)
    return fit, equations


def measure_own_delay(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, joint: int
) -> tuple[float, float]:
    """By how much later than all the torque of a joint is, and the standard deviation [s]; none where it has no term.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
        joint: Number of the joint.
    """
    if _find(fit, joint) is None:
        return 0.0, 0.0
    value, deviation = _read(fit, joint)
    there = equations.with_torque(rows, _move(equations.own_delays, joint, deviation))
    other, _ = _read(fit_arm(fit.arm, there, fit.model, prior, fit), joint)
    more = value - float(equations.own_delays[joint])
    seen = measure_seen(other - float(there.own_delays[joint]), more, deviation)
    return float(equations.own_delays[joint]) + more / seen, deviation / seen


def _find(fit: ArmFit, joint: int) -> int | None:
    """Place of a joint's own delay among the parameters; None for none."""
    place, names = fit.find_friction(joint)
    (name,) = TERMS["torque_delay"].names(0)
    return place.start + names.index(name) if name in names else None


def _read(fit: ArmFit, joint: int) -> tuple[float, float]:
    at = _find(fit, joint)
    return float(fit.x[at]), float(np.sqrt(fit.covariance[at, at]))


def _move(delays: FloatArray, joint: int, by: float) -> FloatArray:
    moved = delays.copy()
    moved[joint] += by
    return moved
