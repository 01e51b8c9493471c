"""A flexible transmission between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from ..transmission import Transmission, carried
from .effect import Context, Effect, EffectParameter, Values, register


@register
class JointElasticity(Effect):
    """J_l theta'' = K (q - theta) + d (q' - theta') - gravity [spong1987]."""

    name = "joint_elasticity"
    kind = "physics"
    equation = "J_l theta'' = K (q - theta) + d (q' - theta') - gravity"
    citation = "spong1987"
    says = "the transmission is flexible"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        low, high = (float(np.log(contexts[0].plant.inertia * w**2)) for w in (15.0, 1500.0))
        return (
            EffectParameter("stiffness", "{torque}/{position}", 0.2, low, high, linear=False, logarithmic=True),
            EffectParameter("load_share", "1", 0.1, 0.05, 0.98, linear=False, prior=0.3),
            EffectParameter("damping_ratio", "1", 0.3, -7.0, 0.0, linear=False, prior=1.0, logarithmic=True),
            EffectParameter("hardening", "1", 0.1, 0.0, 5.0, linear=False, prior=1.0),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.kept(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        inertia, ratio = 0.6 * contexts[0].plant.inertia, float(np.log(0.06))
        return [
            {"stiffness": float(np.log(inertia * w**2)), "load_share": 0.6, "damping_ratio": ratio}
            for w in np.geomspace(40.0, 500.0, 40)
        ]

    def contribution(self, context: Context, values: Values) -> Contribution:
        stiffness, ratio = (float(np.exp(values[name])) for name in ("stiffness", "damping_ratio"))
        inertia = context.plant.inertia * values["load_share"]
        return Contribution(
            additive=carried(context, Transmission(inertia, stiffness, ratio, hardening=values["hardening"]))
        )
