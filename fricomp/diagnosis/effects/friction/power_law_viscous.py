"""Viscous friction that grows less than in proportion to speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import PowerLawViscous as PowerLawViscousTerm
from fricomp.laws import Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class PowerLawViscous(Effect):
    """tau_f = c |v|^n sgn(v) [wolf2018]."""

    name = "power_law_viscous"
    kind = "physics"
    equation = "tau_f = c |v|^n sgn(v)"
    citation = "wolf2018"
    says = "viscous friction is concave in speed"
    viscous_exponent = "exponent"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale, top = contexts[0].scale, max(float(np.max(np.abs(c.velocity))) for c in contexts)
        # Exponents below 0.35 make dry friction of the curve and above 0.92 viscous friction, as far as rows tell; the
        # scale is that of a tenth of the dry level at top speed, for an exponent in the middle.
        return (
            EffectParameter("coefficient", "{torque}·(s/{position})^n", 0.1 * scale / top**0.7, form=0.15),
            EffectParameter("exponent", "1", 0.1, 0.35, 0.92, linear=False, prior=0.15, form=0.2, searched=True),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # From either side of the middle.
        return [{"exponent": 0.5}, {"exponent": 0.75}]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        v = context.velocity
        return Contribution(additive=values["coefficient"] * np.sign(v) * np.abs(v) ** values["exponent"])

    def compute_curve(self, values: Values, speed: float) -> float | None:
        return float(values["coefficient"] * speed ** values["exponent"])

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the curve would be convex" if values["coefficient"] <= 0.0 else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        return PowerLawViscousTerm(values["coefficient"], values["exponent"])
