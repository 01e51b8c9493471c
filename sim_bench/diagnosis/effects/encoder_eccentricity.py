"""An encoder disc that is mounted off its centre."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register


@register
class EncoderEccentricity(Effect):
    """q_recorded = q + A sin(q + phi)."""

    name = "encoder_eccentricity"
    kind = "measurement"
    equation = "q_recorded = q + A sin(q + phi)"
    citation = ""
    says = "the encoder reads once per turn wrong"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        size = 1e-3
        return tuple(EffectParameter(n, "{position}", size, -0.1, 0.1) for n in ("sine", "cosine"))

    def contribution(self, context: Context, values: Values) -> Contribution:
        q, v, a = context.position, context.velocity, context.acceleration
        sine, cosine = np.sin(q), np.cos(q)
        error = values["sine"] * sine + values["cosine"] * cosine
        slope = values["sine"] * cosine - values["cosine"] * sine
        plant = context.plant
        gradient = plant.gravity[1] * cosine - plant.gravity[0] * sine
        viscous = np.where(v >= 0.0, plant.forward[3], plant.reverse[3])
        torque = gradient * error + plant.inertia * (slope * a - error * v**2) + viscous * slope * v
        return Contribution(additive=-torque)

    def unavailable(self, contexts: Sequence[Context]) -> str | None:
        return None if contexts[0].rotary else "the joint is linear"
