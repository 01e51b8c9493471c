"""Inertial coupling with a neighbouring joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...inputs.track import differentiate
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class NeighbourCoupling(Effect):
    """tau = M_12 a_2 cos q_2 + c v_2^2 sin q_2 [siciliano2009]."""

    name = "neighbour_coupling"
    kind = "physics"
    equation = "tau = M_12 a_2 cos q_2 + c v_2^2 sin q_2"
    citation = "siciliano2009"
    says = "the motion of a neighbouring joint is felt here"
    shown_at_rest = True

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (
            EffectParameter("inertia", "kg·m²", EFFECT.step * scale),
            EffectParameter("centrifugal", "kg·m²", EFFECT.step * scale),
        )

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        q = context.channels.get("neighbour_position", np.zeros_like(context.position))  # at rest where unknown
        v = differentiate(q, context.dt)
        a = differentiate(v, context.dt)
        torque = values["inertia"] * a * np.cos(q) + values["centrifugal"] * v**2 * np.sin(q)
        return Contribution(additive=torque)

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        known = all("neighbour_position" in c.channels for c in contexts)
        return None if known else "no neighbour's position is recorded"
