"""Friction that falls as the joint warms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from ..warming import heat_of
from .effect import Context, Effect, EffectParameter, Values, register


@register
class ThermalFriction(Effect):
    """tau_f = F_v (1 - beta dT) v + F_c (1 - gamma dT) sgn(v) [simoni2015]."""

    name = "thermal_friction"
    kind = "physics"
    equation = "tau_f = F_v (1 - beta dT) v + F_c (1 - gamma dT) sgn(v)"
    citation = "simoni2015"
    says = "friction changes with the temperature of the joint"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        viscous = max(max(c.plant.forward[3], c.plant.reverse[3]) for c in contexts)
        largest = max(float(np.max(np.abs(heat_of(c, 30.0)))) for c in contexts)
        unit = "{torque}·s/{position}/K" if "temperature" in contexts[0].channels else "{torque}·s/{position}"
        return (
            EffectParameter("viscous_slope", unit, 0.05 * (viscous + 0.1 * contexts[0].scale) / largest, -1e6, 1e6),
            EffectParameter("time_constant", "s", 0.0, 0.0, 1e4, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        if "temperature" in contexts[0].channels:
            return [{"time_constant": 0.0}]
        return [{"time_constant": tau} for tau in (10.0, 30.0, 100.0)]

    def contribution(self, context: Context, values: Values) -> Contribution:
        heat = heat_of(context, values["time_constant"])
        return Contribution(additive=-values["viscous_slope"] * heat * context.velocity)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "friction would rise with temperature" if values["viscous_slope"] <= 0.0 else None
