"""Torque ripple that is fixed in the angle."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.laws import COGGING_TERMS, Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, compute_lowest_order, refuse_long_wave, register
from ..overtones import build_ripple_terms, compute_wave
from ..settings import EFFECT


@register
class Cogging(Effect):
    """tau = A sin(n q + phi) [piccoli2016]; A and phi for each recording, as an incremental encoder starts anew."""

    name = "cogging"
    kind = "physics"
    equation = "tau = A sin(n q + phi)"
    citation = "piccoli2016"
    says = "a torque ripple is fixed in the angle, whatever the speed"
    ripple = True
    wave = "torque"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale, lowest = EFFECT.small_step * contexts[0].scale, compute_lowest_order(contexts)
        waves = [EffectParameter(name, "{torque}", scale) for name in ("sine", "cosine")]
        order = EffectParameter("order", "1/{position}", EFFECT.order_step, lowest, linear=False)
        further = [
            EffectParameter(f"{wave.name}_{number}", wave.unit, scale)
            for number in range(2, max(context.source for context in contexts) + 2)
            for wave in waves
        ]
        return (*waves, order, *further)

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        lowest = compute_lowest_order(contexts)
        return [{"order": n} for n in contexts[0].hints.get("order", ()) if n >= lowest]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        recording = f"_{context.source + 1}" if context.source else ""
        return Contribution(additive=compute_wave(values, context.position, recording))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return refuse_long_wave(values["order"], contexts)

    def build_terms(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> tuple[Term, ...]:
        return build_ripple_terms(COGGING_TERMS, values)
