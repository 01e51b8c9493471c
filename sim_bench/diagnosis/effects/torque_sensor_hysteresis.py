"""A torque sensor whose reading depends on where it came from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..kernel import play
from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register


@register
class TorqueSensorHysteresis(Effect):
    """r = h (tau_l - play(tau_l, w)) [brokate1996]."""

    name = "torque_sensor_hysteresis"
    kind = "measurement"
    equation = "r = h (tau_l - play(tau_l, w))"
    citation = "brokate1996"
    says = "the torque reading lags behind the load in a loop"
    located_by = "load_torque"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        return (
            EffectParameter("height", "1", 0.01, -0.5, 0.5),
            EffectParameter("width", "1", 0.0, 0.0, 1.0, linear=False),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"width": 0.02}, {"width": 0.08}, {"width": 0.25}]

    def contribution(self, context: Context, values: Values) -> Contribution:
        load = context.torque
        width = values["width"] * float(np.max(np.abs(load)))
        return Contribution(additive=values["height"] * (load - play(load, width)))
