"""A payload that differs between the recordings: gravity and inertia of each one after the first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class PayloadError(Effect):
    """tau = dg_c cos q + dg_s sin q + dJ a, in each recording after the first [hollerbach2016]."""

    name = "payload_error"
    kind = "parameter"
    equation = "tau = dg_c cos q + dg_s sin q + dJ a, of each recording after the first"
    citation = "hollerbach2016"
    says = "the recordings were made with different loads"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        first = contexts[0]
        gravity = EFFECT.step * (float(np.max(np.abs(first.gravity))) + first.scale)
        inertia = EFFECT.step * first.plant.inertia
        result: list[EffectParameter] = []
        for number in range(2, max(*(context.source + 1 for context in contexts), 2) + 1):
            if first.rotary:
                result.append(EffectParameter(f"gravity_cos_{number}", "{torque}", gravity))
                result.append(EffectParameter(f"gravity_sin_{number}", "{torque}", gravity))
            result.append(EffectParameter(f"inertia_{number}", "{torque}·s²/{position}", inertia))
        return tuple(result)

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        return None if any(context.source for context in contexts) else "there is one recording only"

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=self.compute_load(context, values))

    def compute_load(self, context: Context, values: Values) -> FloatArray | float:
        if context.source == 0:
            return 0.0
        number, (cosine, sine) = context.source + 1, context.waves
        torque = values[f"inertia_{number}"] * context.acceleration
        if context.rotary:
            torque = torque + values[f"gravity_cos_{number}"] * cosine + values[f"gravity_sin_{number}"] * sine
        return torque

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        lost = [-value for name, value in values.items() if name.startswith("inertia_")]
        return "the joint would have no inertia left" if max(lost) >= contexts[0].plant.inertia else None
