"""How late the torques of joints are beside each other."""

from __future__ import annotations

from collections.abc import Mapping

from fricomp.root_mean_square import compute_rms

from ..identification import ArmIdentification
from ..matter import LEAST_MATTER


def list_apart(found: ArmIdentification) -> Mapping[int, float]:
    """The delay that each joint asks for [s] by its number, where joints do not agree by what anybody would notice.

    Without noise they never agree: filters, and rows that hold until the next one, are seen in each.
    """
    _, friction = found.fit.predict(found.equations)
    for j, delay in found.delay.apart.items():
        moving = found.equations.moving[:, j]
        change = abs(delay - found.delay.value) * compute_rms(found.rows.torque_rate[moving, j])
        if change >= LEAST_MATTER * compute_rms(friction[moving, j]):
            return found.delay.apart
    return {}
