"""A torque signal with a wrong scale."""

from __future__ import annotations

from collections.abc import Sequence

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class TorqueGainError(Effect):
    """tau_recorded = (1 + eps) tau [hollerbach2016]."""

    name = "torque_gain_error"
    kind = "measurement"
    equation = "tau_recorded = (1 + eps) tau"
    citation = "hollerbach2016"
    says = "the recorded torque has a wrong scale"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A gain that is wrong by half or more is one of units, which the checks of a recording report.
        return (EffectParameter("gain_error", "1", EFFECT.small_step, -0.5, 0.5),)

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=values["gain_error"] * context.torque)

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        return "a gain scales inertia, gravity and friction alike: compare with a simulation whose inertia is known"
