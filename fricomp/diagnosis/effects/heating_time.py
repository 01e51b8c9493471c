"""How fast a joint warms of itself, where nobody recorded its temperature."""

from __future__ import annotations

import numpy as np

from .effect import EffectParameter

__all__ = ["HEATING_TIME", "propose_heating_times"]

_SHORTEST, _LONGEST = 1.0, 1000.0  # [s] from a winding to a gearbox
_STARTS = (10.0, 30.0, 100.0)  # [s]

# A body of several masses is no first order: its one time constant depends on how long it is watched.
HEATING_TIME = EffectParameter(
    "time_constant",
    "s",
    0.3,
    float(np.log(_SHORTEST)),
    float(np.log(_LONGEST)),
    linear=False,
    prior=1.0,
    known=float(np.log(_LONGEST / _SHORTEST)) / (2.0 * 1.96),  # its domain, which starts lie all over
    logarithmic=True,
    form=0.2,
)


def propose_heating_times() -> list[dict[str, float]]:
    """Time constants to start from."""
    return [{"time_constant": float(np.log(time))} for time in _STARTS]
