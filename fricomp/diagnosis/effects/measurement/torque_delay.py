"""A torque signal that is late."""

from __future__ import annotations

from collections.abc import Sequence

from ...joint.base import is_at_latest
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class TorqueDelay(Effect):
    """tau_recorded(t) = tau(t - T_d) [hollerbach2016]."""

    name = "torque_delay"
    kind = "measurement"
    equation = "tau_recorded(t) = tau(t - T_d)"
    citation = "hollerbach2016"
    says = "the recorded torque is late"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # Late by a row at most, or early where the position is filtered; more is a recording of another moment.
        return (
            EffectParameter(
                "delay", "s", 1e-3, -0.03, 0.05, linear=False, form=0.05, with_delay=-1.0, null=0.0, searched=True
            ),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Late by some samples, late by many, and early.
        return [{"delay": 1e-3}, {"delay": 4e-3}, {"delay": -1e-3}]

    def is_suspected(self, contexts: Sequence[Context]) -> bool:
        """The base's own delay is as long as it may be."""
        return is_at_latest(contexts[0].plant, contexts[0].delays[1])

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(delay=values["delay"])

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["delay"] <= 0.0:
            return "the torque would be recorded before it acts"
        return None
