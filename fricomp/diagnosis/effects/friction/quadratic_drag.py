"""Drag that grows with the square of the speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import QuadraticDrag as QuadraticDragTerm
from fricomp.laws import Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class QuadraticDrag(Effect):
    """tau_f = c v |v| [bittencourt2010]."""

    name = "quadratic_drag"
    kind = "physics"
    equation = "tau_f = c v |v|"
    citation = "bittencourt2010"
    says = "friction grows faster than in proportion to speed"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale, top = contexts[0].scale, max(float(np.max(np.abs(c.velocity))) for c in contexts)
        return (EffectParameter("coefficient", "{torque}·s²/{position}²", EFFECT.step * scale / top**2, form=0.07),)

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        v = context.velocity
        return Contribution(additive=values["coefficient"] * v * np.abs(v))

    def compute_curve(self, values: Values, speed: float) -> float | None:
        return values["coefficient"] * speed**2

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "drag would drive the joint" if values["coefficient"] <= 0.0 else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        return QuadraticDragTerm(values["coefficient"])
