"""Friction that follows the velocity late."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from fricomp.laws import FrictionLaw, LaggedLuGre, LaggedStribeck

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class FrictionalLag(Effect):
    """tau_f(t) = F(v(t - tau_L)) [hess1990]."""

    name = "frictional_lag"
    kind = "physics"
    equation = "tau_f(t) = F(v(t - tau_L))"
    citation = "hess1990"
    says = "the friction level follows the velocity with a lag"
    shortest_lag: ClassVar[float] = 1.5e-3
    """Lag below which it is too faint to be named [s]. A bristle of another form has been seen to look like 1.3 ms."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A lag of more than 0.1 s spans two rows: friction would follow the last stroke and not this one.
        return (EffectParameter("lag", "s", 2e-3, 0.0, 0.1, linear=False),)

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # From a lag that is just seen to ten times that.
        return [{"lag": 2e-3}, {"lag": 8e-3}, {"lag": 2e-2}]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(plant={"lag": values["lag"]})

    def is_in_law(self, law: FrictionLaw) -> bool:
        return any(isinstance(term, LaggedStribeck | LaggedLuGre) for term in law.terms)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the lag is shorter than recordings can show" if self.is_faint(values, contexts) else None

    def is_faint(self, values: Values, contexts: Sequence[Context]) -> bool:
        return values["lag"] < max(contexts[0].dt, self.shortest_lag)
