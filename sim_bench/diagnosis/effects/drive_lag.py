"""A drive whose torque follows its command through a low pass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from ..base import LONGEST_DELAY
from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register


@register
class DriveLag(Effect):
    """tau = tau_command / (1 + T s) [hollerbach2016]."""

    name = "drive_lag"
    kind = "measurement"
    equation = "tau = tau_command / (1 + T s)"
    citation = "hollerbach2016"
    says = "the torque that acts follows the recorded one through a low pass"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        return (EffectParameter("time_constant", "s", 2e-3, 0.0, 0.05, linear=False),)

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"time_constant": 2e-3}, {"time_constant": 6e-3}]

    def suspected(self, contexts: Sequence[Context]) -> bool:
        """The base's own delay is as long as it may be."""
        return contexts[0].plant.delay > 0.9 * LONGEST_DELAY

    def contribution(self, context: Context, values: Values) -> Contribution:
        torque, lag = context.torque, values["time_constant"]
        if lag < 1e-6:
            return Contribution()
        keep = float(np.exp(-context.dt / lag))
        acting, _ = lfilter([1.0 - keep], [1.0, -keep], torque, zi=[keep * torque[0]])
        return Contribution(additive=torque - acting)
