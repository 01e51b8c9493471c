"""An encoder disc that is mounted off its centre."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register

_ROUNDS = 4  # towards the position at which the error is made


@register
class EncoderEccentricity(Effect):
    """q_recorded = q + A sin(n q + phi), n = 1 or 2."""

    name = "encoder_eccentricity"
    kind = "measurement"
    equation = "q_recorded = q + A sin(n q + phi)"
    citation = ""
    says = "the encoder reads once or twice per turn wrong"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        size = 1e-3
        wave = tuple(EffectParameter(n, "{position}", size, -0.1, 0.1) for n in ("sine", "cosine"))
        return (*wave, EffectParameter("order", "1/rev", 0.0, 1.0, 2.0, linear=False))

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"order": 1.0}, {"order": 2.0}]

    def contribution(self, context: Context, values: Values) -> Contribution:
        sine, cosine, order = values["sine"], values["cosine"], values["order"]
        q = context.position
        for _ in range(_ROUNDS):
            q = context.position - sine * np.sin(order * q) - cosine * np.cos(order * q)
        wave = sine * np.sin(order * q) + cosine * np.cos(order * q)
        slope = order * (sine * np.cos(order * q) - cosine * np.sin(order * q))
        v = context.velocity / (1.0 + slope)
        a = (context.acceleration + order**2 * wave * v**2) / (1.0 + slope)
        plant = context.plant
        gravity = plant.static_torque(np.cos(q), np.sin(q)) - plant.static_torque(*context.waves)
        viscous = np.where(v >= 0.0, plant.forward[3], plant.reverse[3])
        return Contribution(
            additive=gravity + plant.inertia * (a - context.acceleration) + viscous * (v - context.velocity)
        )

    def unavailable(self, contexts: Sequence[Context]) -> str | None:
        return None if contexts[0].rotary else "the joint is linear"
