"""A torque from outside, in one stretch of time: a push, a contact, a hanging cable that catches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register


@register
class ExternalDisturbance(Effect):
    """tau = A [t_0 < t < t_1]."""

    name = "external_disturbance"
    kind = "physics"
    equation = "tau = A [t_0 < t < t_1]"
    citation = ""
    says = "a torque from outside acts for a while; it is no function of the joint's state"
    located_by = "time"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (
            EffectParameter("torque", "{torque}", 0.05 * scale, -1e5, 1e5),
            EffectParameter("start", "s", 0.02, 0.0, 1e6, linear=False),
            EffectParameter("end", "s", 0.02, 0.0, 1e6, linear=False),
            EffectParameter("recording", "1", 0.0, 0.0, 1e4, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        hints = contexts[0].hints.get("window", ())
        return [
            {"start": a, "end": b, "recording": which}
            for which, a, b in zip(hints[::3], hints[1::3], hints[2::3], strict=True)
        ]

    def contribution(self, context: Context, values: Values) -> Contribution:
        if context.index != round(values["recording"]):
            return Contribution()
        ramp = 0.02
        time = context.time
        rising = np.clip((time - values["start"]) / ramp, 0.0, 1.0)
        falling = np.clip((values["end"] - time) / ramp, 0.0, 1.0)
        return Contribution(additive=values["torque"] * rising * falling)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        longest = max(float(c.time[-1]) for c in contexts)
        return (
            "it would last for more than half of the recording"
            if values["end"] - values["start"] > 0.5 * longest
            else None
        )
