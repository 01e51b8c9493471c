"""A motor whose torque constant falls as it warms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, refuse_large_loss, register
from ..heating_time import HEATING_TIME, propose_heating_times
from ..settings import EFFECT
from ..warming import compute_warming


@register
class TorqueConstantHeating(Effect):
    """tau = tau_recorded (1 - alpha dT), dT from the dissipated current [pillay1989]."""

    name = "torque_constant_heating"
    kind = "physics"
    equation = "tau = tau_recorded (1 - alpha dT), dT from the dissipated current"
    citation = "pillay1989"
    says = "the torque constant falls as the motor warms"
    scales_torque = True
    winding_time: ClassVar[EffectParameter] = replace(HEATING_TIME, form=0.4)
    """Time constant of the winding [s]. A motor that loses much of its torque over 15 s was given 23 and 29 s: up
    to twice as long."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A motor that lost nine tenths of its torque constant would be demagnetised.
        return EffectParameter("loss", "1", EFFECT.small_step, -0.9, 0.9), self.winding_time

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return propose_heating_times()

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=_compute_share(context, values) * context.torque)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["loss"] <= 0.0:
            return "the torque constant would rise"
        return refuse_large_loss([_compute_share(context, values) for context in contexts])


def _compute_share(context: Context, values: Values) -> FloatArray:
    """Part of the torque that is missing [1]. Shape (n,)."""
    past, time_constant = context.past, float(np.exp(values["time_constant"]))
    square, begin = (None, 0.0) if past is None else (past.square, past.begin)
    warming = compute_warming(context.torque**2, context.dt, time_constant, square, begin)
    return values["loss"] * warming.rise
