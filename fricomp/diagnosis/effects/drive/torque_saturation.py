"""A drive whose torque falls short at high current, or stops at a limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, refuse_large_loss, register
from ..settings import EFFECT


@register
class TorqueSaturation(Effect):
    """tau = tau_recorded - c tau_recorded^3 [pillay1989], within a limit.

    Iron that saturates takes off smoothly; a current limit takes off all that a command asks for beyond it.
    """

    name = "torque_saturation"
    kind = "physics"
    equation = "tau = tau_recorded - c tau_recorded^3, |tau_recorded| up to a limit L"
    citation = "pillay1989"
    says = "the torque falls short of the recorded one at high torque"
    seldom: ClassVar[tuple[float, ...]] = (0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995)
    """Parts of the samples that lie below the limits which are tried."""
    limit_step: ClassVar[float] = 0.02
    """Change of the limit that matters, and the least limit, over the largest torque."""
    end: ClassVar[float] = 0.02
    """Part of the range at each end of it within which a stop takes what a limit seems to."""
    at_end: ClassVar[float] = 0.9
    """Part of what is lost beyond the limit that is lost there, from which it is a stop's."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        largest = _find_largest(contexts)
        step = self.limit_step * largest
        return (
            EffectParameter("coefficient", "1/{torque}²", EFFECT.small_step / largest**2, -10.0, 10.0, form=0.15),
            EffectParameter("limit", "{torque}", step, step, largest, linear=False, null=largest),
        )

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        sizes = np.abs(np.concatenate([context.recorded for context in contexts]))
        return [{"limit": float(limit)} for limit in np.unique(np.quantile(sizes, self.seldom))]

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"limit": _find_largest(contexts)}, *self.recall_starts(contexts)]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        smooth = values["coefficient"] * context.torque**3
        return Contribution(additive=smooth + _cut_beyond(context, values["limit"]))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        beyond = np.concatenate([_cut_beyond(context, values["limit"]) for context in contexts])
        largest, cut = _find_largest(contexts), bool(np.any(beyond))
        most = min(values["limit"], largest)
        gained = -values["coefficient"] * most**3
        if gained >= (self.limit_step * most if cut else 0.0):
            return "the torque would exceed the recorded one"
        if not cut:
            return refuse_large_loss([values["coefficient"] * context.torque**2 for context in contexts])
        if np.mean(beyond != 0.0) > 1.0 - self.seldom[0]:
            return "most of the recording would lie beyond the limit, where any torque is as good as another"
        position = np.concatenate([context.position for context in contexts])
        low, high = float(position.min()), float(position.max())
        margin = self.end * (high - low)
        at_ends = [float(np.sum(beyond[near] ** 2)) for near in (position < low + margin, position > high - margin)]
        alone = max(at_ends) > self.at_end * float(np.sum(beyond**2))
        return "the torque is lost at one end of the range alone, as to a stop" if alone else None


def _find_largest(contexts: Sequence[Context]) -> float:
    return max(float(np.max(np.abs(context.recorded))) for context in contexts)


def _cut_beyond(context: Context, limit: float) -> FloatArray:
    """What the recorded torque asks for beyond the limit [N·m]. Shape (n,)."""
    result: FloatArray = context.recorded - np.clip(context.recorded, -limit, limit)
    return result
