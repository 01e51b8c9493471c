"""A flexible transmission between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from ..transmission import carried
from .effect import Context, Effect, EffectParameter, Values, register


@register
class JointElasticity(Effect):
    """J_l theta'' = K (q - theta) + d (q' - theta') - gravity [spong1987]."""

    name = "joint_elasticity"
    kind = "physics"
    equation = "J_l theta'' = K (q - theta) + d (q' - theta') - gravity"
    citation = "spong1987"
    says = "the transmission is flexible"
    located_by = "acceleration"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        return (
            EffectParameter("stiffness", "{torque}/{position}", 0.3, 0.0, 30.0, linear=False, logarithmic=True),
            EffectParameter("load_share", "1", 0.1, 0.05, 0.98, linear=False, prior=0.3),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        size = contexts[0].plant.inertia
        return [{"stiffness": float(np.log(size * w**2)), "load_share": 0.7} for w in (60.0, 120.0, 250.0)]

    def contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=carried(context, float(np.exp(values["stiffness"])), values["load_share"], 0.0))
