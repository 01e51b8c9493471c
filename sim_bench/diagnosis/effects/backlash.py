"""A gap between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from ..transmission import carried
from .effect import Context, Effect, EffectParameter, Values, register


@register
class Backlash(Effect):
    """J_l theta'' = K dz(q - theta, eps) - gravity [nordin2002]."""

    name = "backlash"
    kind = "physics"
    equation = "J_l theta'' = K dz(q - theta, eps) - gravity"
    citation = "nordin2002"
    says = "a gap lets the load go whenever the transmitted torque changes sign"
    located_by = "load_torque"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        return (
            EffectParameter(
                "gap", "{position}", 0.4, float(np.log(5e-5)), float(np.log(3e-2)), linear=False, logarithmic=True
            ),
            EffectParameter("load_share", "1", 0.1, 0.05, 0.98, linear=False, prior=0.3),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"gap": float(np.log(g)), "load_share": 0.7} for g in (3e-4, 1e-3, 3e-3)]

    def contribution(self, context: Context, values: Values) -> Contribution:
        stiffness = context.plant.inertia * values["load_share"] * 400.0**2
        gap = float(np.exp(values["gap"]))
        return Contribution(additive=carried(context, stiffness, values["load_share"], gap))

    def unavailable(self, contexts: Sequence[Context]) -> str | None:
        crosses = max(int(np.sum(np.diff(np.sign(c.load_torque)) != 0)) for c in contexts)
        return "the transmitted torque never changes sign" if crosses < 2 else None
