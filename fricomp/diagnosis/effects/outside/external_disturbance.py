"""A torque from outside, in a few stretches of time: a push, a contact, a hanging cable that catches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from fricomp.root_mean_square import compute_rms

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT
from ..time_window import shape_push


@register
class ExternalDisturbance(Effect):
    """tau = sum of A_k sin(pi (t - t_k) / T_k)^n_k over the windows k."""

    name = "external_disturbance"
    kind = "physics"
    equation = "tau = sum of A_k sin(pi (t - t_k) / T_k)^n_k"
    citation = ""
    says = (
        "a torque from outside acts for a while, given as what the motor bears, so that the push itself has the other "
        "sign; it is no function of the joint's state"
    )
    gain_share = 0.8  # Pushes in windows of time imitate anything that comes and goes.
    imitates_others = True
    end_step: ClassVar[float] = 0.05
    """Change of an end of a push that matters [s]."""
    roundness: ClassVar[EffectParameter] = EffectParameter(
        "roundness", "1", 0.2, -3.0, 1.5, linear=False, prior=1.0, logarithmic=True
    )
    """Power of half a sine that a push is, from a block to a peak of a third of its window; e^0.2 makes it another."""
    shortest: ClassVar[float] = 0.2
    """Least length of the longest window [s], ten rows. Shorter ones have been seen of drives that could not follow."""
    slow: ClassVar[float] = 0.1
    """Part of the usual speed below which a joint hardly moves; some 5 % of a swing."""
    coincidence: ClassVar[float] = 0.01
    """Chance below which pushes do not fall into such moments of themselves. One that does may be a push."""
    edge: ClassVar[float] = 0.04
    """Standard deviation of the ends of a push [s]. One with sharp edges is not the power of a sine that is fitted:
    such ends were 5 to 81 ms off (38 ms rms), and its torque 7 % too large, as the sine is pointed."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = EFFECT.step * contexts[0].scale
        found: list[EffectParameter] = []
        for k in range(1, len(_list_windows(contexts)) + 1):
            found += [
                EffectParameter(f"torque_{k}", "{torque}", scale, form=0.05),
                EffectParameter(f"start_{k}", "s", self.end_step, 0.0, linear=False, least_form=self.edge),
                EffectParameter(f"end_{k}", "s", self.end_step, 0.0, linear=False, least_form=self.edge),
                replace(self.roundness, name=f"roundness_{k}"),
            ]
        return tuple(found)

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        windows = _list_windows(contexts)
        values = {f"start_{k}": start for k, (_, start, _) in enumerate(windows, start=1)}
        values |= {f"end_{k}": end for k, (_, _, end) in enumerate(windows, start=1)}
        return [values] if windows else []

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        torque = np.zeros_like(context.position)
        for k, (which, _, _) in enumerate(_list_windows([context]), start=1):
            if which == context.index:
                torque += values[f"torque_{k}"] * _shape_window(context, values, k)
        return Contribution(additive=torque)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        count = len(_list_windows(contexts))
        longest = max(values[f"end_{k}"] - values[f"start_{k}"] for k in range(1, count + 1))
        if longest < self.shortest:
            return "so short a push shows no more than that something was amiss"
        return "the pushes come with the reversals of the joint" if self._follows_reversals(values, contexts) else None

    def _follows_reversals(self, values: Values, contexts: Sequence[Context]) -> bool:
        """Whether all pushes fall into moments in which the joint hardly moves, too many to do so by chance: a friction
        that acts late or turns over in another way does, and nobody who pushes."""
        speeds = np.concatenate([np.abs(context.velocity) for context in contexts])
        slow = self.slow * compute_rms(speeds)
        windows = _list_windows(contexts)
        means = []
        for k, (which, _, _) in enumerate(windows, start=1):
            (context,) = (one for one in contexts if one.index == which)
            shape = _shape_window(context, values, k)
            means.append(float(np.abs(context.velocity) @ shape) / max(float(np.sum(shape)), 1e-12))
        return max(means) < slow and float(np.mean(speeds < slow)) ** len(windows) < self.coincidence


def _shape_window(context: Context, values: Values, k: int) -> FloatArray:
    """Shape of push `k`, 1 at its peak. Shape (n,)."""
    return shape_push(context.time, values[f"start_{k}"], values[f"end_{k}"], float(np.exp(values[f"roundness_{k}"])))


def _list_windows(contexts: Sequence[Context]) -> list[tuple[float, float, float]]:
    """Recording, start and end of the windows that stand out of the base's residual."""
    hints = contexts[0].hints.get("window", ())
    return list(zip(hints[::3], hints[1::3], hints[2::3], strict=True))
