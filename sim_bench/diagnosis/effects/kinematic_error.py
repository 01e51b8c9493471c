"""A transmission error of the gear, felt through the inertia."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, lowest_order, register


@register
class KinematicError(Effect):
    """tau = J d²/dt² A sin(n q + phi) [tuttle1992]."""

    name = "kinematic_error"
    kind = "physics"
    equation = "tau = J d²/dt² A sin(n q + phi)"
    citation = "tuttle1992"
    says = "the gear runs unevenly, felt as a ripple that grows with the square of the speed"
    located_by = "velocity"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        top = max(float(np.max(np.abs(c.velocity))) for c in contexts)
        size = 0.02 * contexts[0].scale / (contexts[0].plant.inertia * top**2)
        return (
            EffectParameter("sine", "1/{position}", size, -1e4, 1e4),
            EffectParameter("cosine", "1/{position}", size, -1e4, 1e4),
            EffectParameter("order", "1/{position}", 0.05, lowest_order(contexts), 1e5, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        lowest = lowest_order(contexts)
        return [{"order": n} for n in contexts[0].hints.get("dynamic_order", ()) if n >= lowest]

    def contribution(self, context: Context, values: Values) -> Contribution:
        n, v, a = values["order"], context.velocity, context.acceleration
        sine, cosine = np.sin(n * context.position), np.cos(n * context.position)
        error_sine = -sine * v**2 + cosine * a / max(n, 1e-6)
        error_cosine = -cosine * v**2 - sine * a / max(n, 1e-6)
        inertia = context.plant.inertia
        return Contribution(additive=inertia * (values["sine"] * error_sine + values["cosine"] * error_cosine))
