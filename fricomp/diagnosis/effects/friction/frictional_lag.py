"""Friction that follows the velocity late."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from scipy.signal import lfilter

from fricomp.laws import FrictionLaw, LaggedLuGre, LaggedStribeck

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class FrictionalLag(Effect):
    """tau_f(t) = F(v(t - tau_L)) of all friction, or of its dry part alone [hess1990].

    Viscous friction that lags is -F_v tau_L a more, as from a smaller inertia: a simulation that says the inertia
    tells the two forms apart.
    """

    name = "frictional_lag"
    kind = "physics"
    equation = "tau_f(t) = F(v(t - tau_L)), or of its dry part alone"
    citation = "hess1990"
    says = "the friction level follows the velocity with a lag"
    shortest_lag: ClassVar[float] = 1.5e-3
    """Lag below which it is too faint to be named [s]. A bristle of another form has been seen to look like 1.3 ms."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A lag of more than 0.1 s spans two rows: friction would follow the last stroke and not this one.
        return (
            EffectParameter("lag", "s", 2e-3, 0.0, 0.1, linear=False, null=0.0, searched=True),
            EffectParameter("dry_alone", "1", 0.0, 0.0, 1.0, linear=False),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # From a lag that is just seen to ten times that.
        return [{"lag": lag, "dry_alone": alone} for alone in (0.0, 1.0) for lag in (2e-3, 8e-3, 2e-2)]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        lag, plant = values["lag"], {"lag": values["lag"]}
        if values["dry_alone"] < 0.5 or lag <= 0.0:
            return Contribution(plant=plant)
        return Contribution(additive=_compute_prompt_part(context, lag), plant=plant)

    def is_in_law(self, law: FrictionLaw) -> bool:
        return any(isinstance(term, LaggedStribeck | LaggedLuGre) for term in law.terms)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the lag is shorter than recordings can show" if self.is_faint(values, contexts) else None

    def is_faint(self, values: Values, contexts: Sequence[Context]) -> bool:
        return values["lag"] < max(contexts[0].dt, self.shortest_lag)


def _compute_prompt_part(context: Context, lag: float) -> FloatArray:
    """What viscous friction is more at the velocity than at the lagging one [N·m]. Shape (n,)."""
    keep, v = float(np.exp(-context.dt / lag)), context.velocity
    late = lfilter([1.0 - keep], [1.0, -keep], v, zi=[keep * v[0]])[0]
    result: FloatArray = np.where(v >= 0.0, context.plant.forward[3], context.plant.reverse[3]) * (v - late)
    return result
