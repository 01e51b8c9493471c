"""Coulomb friction that waves with the angle."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.laws import POSITION_COULOMB_TERMS, Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..overtones import build_ripple_terms, compute_wave
from ..settings import EFFECT

_EVEN = "friction that is the same everywhere"


@register
class PositionCoulomb(Effect):
    """tau_f = (a cos n q + b sin n q) sgn(v) [bittencourt2010]."""

    name = "position_coulomb"
    kind = "physics"
    equation = "tau_f = (a cos n q + b sin n q) sgn(v)"
    citation = "bittencourt2010"
    says = "the friction level waves with the position"
    ripple = True
    wave = "friction"
    gain_share = 0.98  # A wave of any order imitates friction under a load that follows the position.
    imitates_others = True

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (
            EffectParameter("sine", "{torque}", EFFECT.step * scale),
            EffectParameter("cosine", "{torque}", EFFECT.step * scale),
            EffectParameter("order", "1/{position}", EFFECT.order_step, 0.0, linear=False, form=0.05, at_lowest=_EVEN),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"order": n} for n in contexts[0].hints.get("level_order", ())]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(level=compute_wave(values, context.position))

    def build_terms(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> tuple[Term, ...]:
        return build_ripple_terms(POSITION_COULOMB_TERMS, values)
