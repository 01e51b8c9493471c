"""How fast a joint warms of itself, where nobody recorded its temperature."""

from __future__ import annotations

import numpy as np

from .effect import EffectParameter
from .settings import EFFECT

HEATING_TIME = EffectParameter(
    "time_constant",
    "s",
    0.3,
    float(np.log(EFFECT.shortest_heating)),
    float(np.log(EFFECT.longest_heating)),
    linear=False,
    prior=1.0,
    known=float(np.log(EFFECT.longest_heating / EFFECT.shortest_heating)) / (2.0 * 1.96),
    logarithmic=True,
    form=0.2,
)
"""Time constant of heating [s]. A body of several masses is no first order: its one time constant depends on how long
it is watched. It is known no better than its domain, since starts lie all over that."""


def propose_heating_times() -> list[dict[str, float]]:
    """Time constants to start from."""
    return [{"time_constant": float(np.log(time))} for time in EFFECT.heating_starts]
