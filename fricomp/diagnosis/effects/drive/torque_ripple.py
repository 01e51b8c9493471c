"""Torque ripple that grows with the torque: the torque constant waves with the angle."""

from __future__ import annotations

from collections.abc import Sequence

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, compute_lowest_order, refuse_long_wave, register
from ..overtones import compute_wave


@register
class TorqueRipple(Effect):
    """tau = tau_recorded (1 - A sin(n q + phi)): a current makes more torque at some angles than at others
    [jahns1996ripple]."""

    name = "torque_ripple"
    kind = "physics"
    equation = "tau = tau_recorded (1 - A sin(n q + phi))"
    citation = "jahns1996ripple"
    says = "the recorded torque makes more or less torque at some angles: a ripple that grows with it"
    ripple = True
    gain_share = 0.98  # Where the torque hardly changes it is a ripple of that torque.

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # One per cent is a good motor; at nine tenths it would hardly turn at some angle.
        waves = [EffectParameter(name, "1", 0.01, -0.9, 0.9) for name in ("sine", "cosine")]
        # An order is known to a part of a wave over some turns.
        order = EffectParameter("order", "1/{position}", 0.05, compute_lowest_order(contexts), 1e5, linear=False)
        return (*waves, order)

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        lowest = compute_lowest_order(contexts)
        return [{"order": n} for n in contexts[0].hints.get("torque_order", ()) if n >= lowest]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=compute_wave(values, context.position) * context.recorded)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return refuse_long_wave(values["order"], contexts)
