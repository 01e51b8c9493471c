"""A torque sensor whose reading depends on where it came from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..kernel import compiled
from ..observer import Contribution
from ..track import FloatArray
from .effect import Context, Effect, EffectParameter, Values, register


@compiled
def loop(torque: np.ndarray, width: float, exponent: float, initial: float) -> np.ndarray:
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
    """r = h z, z' = tau' (1 - [z tau' > 0] |z / w|^n) [wen1976]."""

    name = "torque_sensor_hysteresis"
    kind = "measurement"
    equation = "r = h z, z' = tau' (1 - [z tau' > 0] |z / w|^n)"
    citation = "wen1976"
    says = "the torque reading lags behind the load in a loop"

    def parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        largest = _largest(contexts)
        low, high = float(np.log(0.005 * largest)), float(np.log(largest))
        return (
            EffectParameter("height", "1", 0.01, -0.5, 0.5),
            EffectParameter("width", "{torque}", 0.2, low, high, linear=False, logarithmic=True, form=0.3),
            EffectParameter("exponent", "1", 0.4, -1.5, 3.0, linear=False, prior=1.5, logarithmic=True),
            EffectParameter("initial", "1", 0.1, -1.0, 1.0, linear=False, prior=1.0),
        )

    def starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.kept(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        widths = np.log(np.geomspace(0.02, 0.5, 8) * _largest(contexts))
        return [
            {"width": float(width), "exponent": exponent, "initial": initial}
            for width in widths
            for exponent in (0.0, 2.0)
            for initial in (-0.7, 0.0, 0.7)
        ]

    def contribution(self, context: Context, values: Values) -> Contribution:
        width, exponent = (float(np.exp(values[name])) for name in ("width", "exponent"))
        state = loop(_torque(context), width, exponent, values["initial"])
        return Contribution(additive=values["height"] * state)


def _torque(context: Context) -> FloatArray:
    """Torque of the base model with its sharp reversals [N·m]. Shape (n,)."""
    return context.gravity + context.plant.inertia * context.acceleration + context.friction


def _largest(contexts: Sequence[Context]) -> float:
    return max(float(np.max(np.abs(context.torque))) for context in contexts)
