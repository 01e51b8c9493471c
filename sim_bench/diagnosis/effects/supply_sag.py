"""A drive whose available torque falls with speed or supply voltage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..observer import Contribution
from .effect import Context, Effect, EffectParameter, Values, register


@register
class SupplySag(Effect):
    """tau = tau_recorded (1 - c |v|), or by the recorded voltage [duclusaud2025bam]."""

    name = "supply_sag"
    kind = "physics"
    equation = "tau = tau_recorded (1 - c |v|), or by the recorded voltage"
    citation = "duclusaud2025bam"
    says = "the torque falls short as the supply sags"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        top = max(float(np.max(np.abs(c.velocity))) for c in contexts)
        unit = "1/V" if "voltage" in contexts[0].channels else "s/{position}"
        swing = max(float(np.ptp(c.channels.get("voltage", np.array([0.0, top])))) for c in contexts)
        return (EffectParameter("coefficient", unit, 0.02 / max(swing, 1e-9), -1e3, 1e3),)

    def contribution(self, context: Context, values: Values) -> Contribution:
        voltage = context.channels.get("voltage")
        sag = np.abs(context.velocity) if voltage is None else np.max(voltage) - voltage
        return Contribution(additive=values["coefficient"] * sag * context.torque)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the torque would rise as the supply sags" if values["coefficient"] <= 0.0 else None
