"""By how much of the friction that the files of a joint hold it would have been compensated best, on held-out data.

g = Σ f r / Σ f²,  r = torque - gravity and inertia,  f = friction of the files
"""

from __future__ import annotations

import numpy as np

from fricomp.diagnosis.record.result import Quantity

from ..fit import Z95
from ..friction import GEARS, PLAIN, TERMS
from ..identification import ArmIdentification
from ..law_fit import fit_within_law
from ..row_weights import BLOCK_TIME, BoolArray

_SIGNALS = ("torque_delay", "torque_gain_error")
"""Terms that are no friction and that no file of a joint holds, as gears that give way are."""


def find_best_gain(found: ArmIdentification, joint: int, used: BoolArray) -> Quantity | None:
    """The gain on the friction of a joint's files that leaves least of some rows; None where that is no friction.

    Args:
        found: With the fit that the files are made of, to other rows.
        joint: Number of the joint.
        used: Rows that count. Shape (n,).
    """
    fit, equations = found.fit, found.equations
    held = [
        (name, k)
        for name, k in fit.model.forms[joint].terms
        if TERMS[name].filled not in GEARS and name not in _SIGNALS
    ]
    names = (*PLAIN, *(column for name, k in held for column in TERMS[name].names(k)))
    columns, fitted, written = equations.friction_of(joint, names), fit.friction(joint), fit_within_law(found, joint)
    friction = columns @ [written[name] for name in names] * used
    wanted = (fit.residuals(equations)[:, joint] + columns @ [fitted[name] for name in names]) * used
    size = float(friction @ friction)
    if size <= 0.0:
        return None
    gain = float(friction @ wanted) / size
    block = np.floor(found.rows.time / BLOCK_TIME).astype(np.intp)
    sums = np.bincount(block - block[0], friction * (wanted - gain * friction))  # rows err together for so long
    spread = Z95 * float(np.linalg.norm(sums)) / size
    return Quantity(gain, "1", (gain - spread, gain + spread))
