"""A torque sensor whose reading depends on where it came from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...joint.kernel import compile_kernel
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@compile_kernel
def follow_loop(torque: np.ndarray, width: float, exponent: float, initial: float) -> np.ndarray:
    """The part of a torque that follows it in a loop and saturates at `width` [N·m]. Shape (n,).

    Bouc and Wen: z' = tau' (1 - |z / w|^n) while z grows, tau' while it falls; a sharp play for large n.
    """
    out = np.empty_like(torque)
    state = initial * width
    for k in range(torque.shape[0]):
        change = torque[k] - torque[max(k - 1, 0)]
        rest = 1.0 - abs(state / width) ** exponent if change * state > 0.0 else 1.0
        state = min(max(state + change * rest, -width), width)
        out[k] = state
    return out


@register
class TorqueSensorHysteresis(Effect):
    """r = h z, z' = tau' (1 - [z tau' > 0] |z / w|^n) [wen1976].

    The loop follows the recorded torque: where the joint sticks, a controller takes it elsewhere than the base model
    needs, and what it makes of the encoder's steps moves the loop too.
    """

    name = "torque_sensor_hysteresis"
    kind = "measurement"
    equation = "r = h z, z' = tau' (1 - [z tau' > 0] |z / w|^n)"
    citation = "wen1976"
    says = "the torque reading lags behind the load in a loop"
    seldom: ClassVar[float] = 0.01
    """Part of the samples at each end that does not count for the reach of the torque."""
    widest: ClassVar[float] = 0.8
    """Largest width in the reach of the torque. A loop that hardly ever saturates is a gain."""
    narrowest: ClassVar[float] = 0.005
    """Least width in the reach of the torque. A narrower loop is a step at each turn, which an offset of dry friction
    is as well."""
    above_noise: ClassVar[float] = 10.0
    """Least width in the noise of the torque. A smaller loop follows that noise, and explains it."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        low, high = (float(value) for value in np.log(_bound_widths(contexts)))
        # A loop of half the torque is a broken sensor. The exponent goes from a wide bend to the corner of a play.
        return (
            EffectParameter("height", "1", 0.01, -0.5, 0.5),
            EffectParameter("width", "{torque}", 0.2, low, high, linear=False, logarithmic=True, form=0.3),
            EffectParameter("exponent", "1", 0.4, -1.5, 3.0, linear=False, prior=1.5, logarithmic=True),
            EffectParameter("initial", "1", 0.1, -1.0, 1.0, linear=False, prior=1.0),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.recall_starts(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        narrowest, widest = _bound_widths(contexts)
        # Widths all over the bounds, each 1.6 times the last: a loop of another width turns elsewhere.
        usual = np.geomspace(0.02, 0.5, 8) * widest / self.widest
        widths = np.log(np.unique(np.maximum(usual, narrowest)))
        return [
            {"width": float(width), "exponent": exponent, "initial": initial}
            for width in widths
            for exponent in (0.0, 2.0)
            for initial in (-0.7, 0.0, 0.7)  # low, in the middle and high in the loop
        ]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        width, exponent = (float(np.exp(values[name])) for name in ("width", "exponent"))
        state = follow_loop(context.recorded, width, exponent, values["initial"])
        return Contribution(additive=values["height"] * state)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "the reading would run ahead of the load" if values["height"] >= 0.0 else None


def _bound_widths(contexts: Sequence[Context]) -> tuple[float, float]:
    """Narrowest and widest loop that shows as one [N·m]: it is no noise, and saturates again and again."""
    ends = [
        np.quantile(context.recorded, [TorqueSensorHysteresis.seldom, 1.0 - TorqueSensorHysteresis.seldom])
        for context in contexts
    ]
    reach = max(0.5 * float(high - low) for low, high in ends)
    noise = max(context.noise for context in contexts)
    least = max(TorqueSensorHysteresis.narrowest * reach, TorqueSensorHysteresis.above_noise * noise)
    most = TorqueSensorHysteresis.widest * reach
    return min(least, 0.5 * most), most
