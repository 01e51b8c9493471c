"""A drive whose torque falls short at high current."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class TorqueSaturation(Effect):
    """tau = tau_recorded - c tau_recorded^3 [pillay1989]."""

    name = "torque_saturation"
    kind = "physics"
    equation = "tau = tau_recorded - c tau_recorded^3"
    citation = "pillay1989"
    says = "the torque falls short of the recorded one at high torque"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        largest = max(float(np.max(np.abs(c.torque))) for c in contexts)
        return (EffectParameter("coefficient", "1/{torque}²", EFFECT.small_step / largest**2, -10.0, 10.0, form=0.15),)

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=values["coefficient"] * context.torque**3)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the torque would exceed the recorded one" if values["coefficient"] <= 0.0 else None
