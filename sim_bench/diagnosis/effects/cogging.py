"""Torque ripple that is fixed in the angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import Cogging as CoggingTerm
from fricomp.laws import Term

from ..observer import Contribution, Plant
from .effect import Context, Effect, EffectParameter, Values, lowest_order, register


@register
class Cogging(Effect):
    """tau = A sin(n q + phi) [piccoli2016]."""

    name = "cogging"
    kind = "physics"
    equation = "tau = A sin(n q + phi)"
    citation = "piccoli2016"
    says = "a torque ripple is fixed in the angle, whatever the speed"
    located_by = "position"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (
            EffectParameter("sine", "{torque}", 0.02 * scale, -1e4, 1e4),
            EffectParameter("cosine", "{torque}", 0.02 * scale, -1e4, 1e4),
            EffectParameter("order", "1/{position}", 0.05, lowest_order(contexts), 1e5, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        lowest = lowest_order(contexts)
        return [{"order": n} for n in contexts[0].hints.get("order", ()) if n >= lowest]

    def contribution(self, context: Context, values: Values) -> Contribution:
        angle = values["order"] * context.position
        return Contribution(additive=values["sine"] * np.sin(angle) + values["cosine"] * np.cos(angle))

    def term(self, values: Values, plant: Plant) -> Term | None:
        return CoggingTerm(values["sine"], values["cosine"], values["order"])
