"""A stop or bumper at the end of the range."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fricomp.laws import EndStop as EndStopTerm
from fricomp.laws import Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class EndStop(Effect):
    """tau = (k (q - q_max) + c v)_+ beyond q_max. A stop dissipates by c, and pushes only."""

    name = "end_stop"
    kind = "physics"
    equation = "tau = max(k (q - q_max) + c v, 0) beyond q_max"
    citation = ""
    says = "a stop pushes back at the end of the range"
    shown_at_rest = True
    edges: ClassVar[tuple[float, ...]] = (0.02, 0.06, 0.12, 0.2)
    """Distances from the ends of the range, in that range, at which a fit looks for the edge of a stop. They lie closer
    at the ends, where a hard stop is met for a short way only."""
    edge_step: ClassVar[float] = 0.02
    """Change of an edge that matters [rad] or [m]."""
    usual_time: ClassVar[float] = 0.02
    """Damping over stiffness that matters [s]."""
    widest: ClassVar[float] = 0.35
    """Largest part of the samples and of the range in which it may act, since a stop is at the end of the range."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        return (
            EffectParameter("stiffness", "{torque}/{position}", scale),
            EffectParameter("damping", "{torque}·s/{position}", self.usual_time * scale, 0.0, null=0.0),
            EffectParameter("edge", "{position}", self.edge_step, linear=False),
            EffectParameter("side", "1", 0.0, -1.0, 1.0, linear=False),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        low, high = _find_range(contexts)
        span = high - low
        upper = [{"edge": high - f * span, "side": 1.0} for f in self.edges]
        return upper + [{"edge": low + f * span, "side": -1.0} for f in self.edges]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        side = values["side"]
        depth = np.maximum(side * (context.position - values["edge"]), 0.0)
        pushed = values["stiffness"] * depth + values["damping"] * side * context.quick_velocity * (depth > 0.0)
        return Contribution(additive=side * np.maximum(pushed, 0.0))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["stiffness"] <= 0.0:
            return "the stop would pull outwards"
        inside = [np.mean(values["side"] * (c.position - values["edge"]) > 0.0) for c in contexts]
        low, high = _find_range(contexts)
        reach = high - values["edge"] if values["side"] > 0.0 else values["edge"] - low
        widest = max(float(np.mean(inside)), reach / (high - low))
        return "it would act over more than a third of the range" if widest > self.widest else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        return EndStopTerm(values["stiffness"], values["edge"], values["side"], values["damping"])


def _find_range(contexts: Sequence[Context]) -> tuple[float, float]:
    """Least and largest position of all recordings [rad] or [m]."""
    return min(float(c.position.min()) for c in contexts), max(float(c.position.max()) for c in contexts)
