"""A drive whose available torque falls with speed or supply voltage."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, refuse_large_loss, register
from ..settings import EFFECT


@register
class SupplySag(Effect):
    """tau = tau_recorded (1 - c |v| - p |tau v|), or by the recorded voltage [duclusaud2025bam]."""

    name = "supply_sag"
    kind = "physics"
    equation = "tau = tau_recorded (1 - c |v| - p |tau v|), or by the recorded voltage"
    citation = "duclusaud2025bam"
    says = "the torque falls short as the supply sags"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        top = max(float(np.max(np.abs(c.velocity))) for c in contexts)
        power = max(float(np.max(np.abs(c.velocity * c.torque))) for c in contexts)
        recorded = "voltage" in contexts[0].channels
        unit = "1/V" if recorded else "s/{position}"
        swing = max(float(np.ptp(c.channels.get("voltage", np.array([0.0, top])))) for c in contexts)
        by_power = 0.0 if recorded else EFFECT.small_step / max(power, 1e-9)
        # Of a loss by power alone, up to 0.0065 of the torque at top speed was taken for a gain by speed.
        traded = 0.0 if recorded else 0.003 / max(swing, 1e-9)
        return (
            EffectParameter("coefficient", unit, EFFECT.small_step / max(swing, 1e-9), form=0.1, least_form=traded),
            EffectParameter("loss_by_power", "s/({torque}·{position})", by_power, form=0.1),
        )

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=_compute_share(context, values) * context.torque)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        shares = [_compute_share(context, values) for context in contexts]
        falls = any(float(np.sum(share * c.torque**2)) > 0.0 for share, c in zip(shares, contexts, strict=True))
        return refuse_large_loss(shares) if falls else "the torque would rise as the supply sags"


def _compute_share(context: Context, values: Values) -> FloatArray:
    """Part of the torque that is missing [1]. Shape (n,)."""
    voltage = context.channels.get("voltage")
    sag = np.abs(context.velocity) if voltage is None else np.max(voltage) - voltage
    power = np.abs(context.velocity * context.torque)
    share: FloatArray = values["coefficient"] * sag + values["loss_by_power"] * power
    return share
