"""A spring between the joint and its base, such as a cable bundle."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.laws import SpringTorque as SpringTorqueTerm
from fricomp.laws import Term

from ..observer import Contribution, Plant
from .effect import Context, Effect, EffectParameter, Values, register


@register
class SpringTorque(Effect):
    """tau = k (q - q_0)."""

    name = "spring_torque"
    kind = "physics"
    equation = "tau = k (q - q_0), q_0 by the offset"
    citation = ""
    says = "a spring pulls the joint"
    shown_at_rest = True
    contains = ("torque_offset",)

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (EffectParameter("stiffness", "{torque}/{position}", 0.05 * scale, -1e6, 1e6),)

    def contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=values["stiffness"] * context.position)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the spring would push away from its centre" if values["stiffness"] <= 0.0 else None

    def term(self, values: Values, plant: Plant) -> Term | None:
        return SpringTorqueTerm(values["stiffness"], 0.0)
