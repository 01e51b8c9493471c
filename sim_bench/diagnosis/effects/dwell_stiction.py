"""Static friction that grows while the joint rests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..kernel import dwell
from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register

_LEAST = 0.02  # of the static friction, that a rise must reach in the longest rest


@register
class DwellStiction(Effect):
    """F_s rises by A (1 - exp(-t_d / tau)) after a rest of t_d [armstrong1994survey]."""

    name = "dwell_stiction"
    kind = "physics"
    equation = "F_s rises by A (1 - exp(-t_d / tau)) after a rest of t_d"
    citation = "armstrong1994survey"
    says = "the breakaway torque grows with the time at rest"
    shown_at_rest = True

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        return (
            EffectParameter("rise", "{torque}", 0.05 * contexts[0].scale, -1e4, 1e4, form=0.4),
            EffectParameter("time_constant", "s", 0.0, 0.0, 1e3, linear=False),
            EffectParameter("travel", "{position}", 0.0, 0.0, 1.0, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"time_constant": t, "travel": d} for t in (0.3, 2.0, 10.0) for d in (1e-3, 1e-2)]

    def contribution(self, context: Context, values: Values) -> Contribution:
        grown = dwell(context.velocity, np.array([context.dt, values["time_constant"], values["travel"], 3e-3]))
        return Contribution(level=values["rise"] * grown)

    def unavailable(self, contexts: Sequence[Context]) -> str | None:
        rests = max(float(np.mean(np.abs(c.velocity) < 3e-3)) for c in contexts)
        return "the joint never rests" if rests < 0.01 else None

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["rise"] <= 0.0:
            return "the static friction would fall at rest"
        reached = max(float(np.max(self.contribution(c, values).level)) for c in contexts)
        least = _LEAST * max(max(c.plant.forward[1], c.plant.reverse[1]) for c in contexts)
        return "the rise is smaller than what laws of presliding differ by" if reached < least else None
