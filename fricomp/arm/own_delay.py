"""The delay of one joint's torque beside the others, moved to where the joint asks for no more of it.

A term of the model is linear in the delay, and the noise of the torque's rate makes it too short: 8 ms came as 6.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .equations import ArmEquations
from .fit import fit_arm
from .friction import TERMS
from .identification import ArmIdentification
from .rows import ArmRows
from .search.shared_delay import measure_seen

_ROUNDS = 6
_STILL = 0.1
"""Of its standard deviation, below which a delay moves no more."""


def find_own_delay(found: ArmIdentification, joint: int) -> tuple[float, float]:
    """By how much later than all the torque of a joint is, and the standard deviation [s]; none where it has no term.

    Args:
        found: The confirmed fit.
        joint: Number of the joint.
    """
    fit, (name,) = found.fit, TERMS["torque_delay"].names(0)
    place, names = fit.find_friction(joint)
    if name not in names:
        return 0.0, 0.0
    at = place.start + names.index(name)
    delay, deviation = float(fit.x[at]), float(np.sqrt(fit.covariance[at, at]))
    moved, before, seen = delay, delay, 1.0
    for _ in range(_ROUNDS):
        rows = found.rows.with_delay(found.recording, found.delay.value + delay)
        equations = _shift_joint(found.equations, rows, joint)
        more = float(fit_arm(fit.arm, equations, fit.model, found.prior, fit).x[at])
        if abs(more) < _STILL * deviation:
            break
        seen = measure_seen(more, before, moved)
        moved, before = more / seen, more
        delay += moved
    return delay, deviation / seen


def _shift_joint(equations: ArmEquations, rows: ArmRows, joint: int) -> ArmEquations:
    """The same with the torque of one joint as these rows have it."""
    columns = list(equations.columns)
    columns[joint] = equations.with_torque(rows).columns[joint]
    return replace(equations, columns=tuple(columns))
