"""Static friction that grows while the joint rests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp
from typing import ClassVar

import numpy as np

from fricomp.laws import DwellStiction as DwellStictionTerm
from fricomp.laws import Term

from ...inputs.track import FloatArray
from ...joint.kernel import compile_kernel
from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..forward_part import ForwardPart, HiddenState
from ..settings import EFFECT


@compile_kernel
def dwell(velocity: np.ndarray, settings: np.ndarray) -> np.ndarray:
    """Share of its final rise that static friction has gained by resting, lost again over a short travel.

    Args:
        velocity: Velocity [rad/s]. Shape (n,).
        settings: dt [s], time constant [s], travel over which it is lost [rad], rest speed [rad/s].
    """
    out = np.empty_like(velocity)
    grown = 0.0
    gain = 1.0 - np.exp(-settings[0] / max(settings[1], 1e-6))
    for k in range(velocity.shape[0]):
        speed = abs(velocity[k])
        if speed < settings[3]:
            grown += gain * (1.0 - grown)
        else:
            grown *= np.exp(-speed * settings[0] / max(settings[2], 1e-9))
        out[k] = grown
    return out


@register
class DwellStiction(Effect):
    """F_s rises by A (1 - exp(-t_d / tau)) after a rest of t_d [armstrong1994survey]."""

    name = "dwell_stiction"
    kind = "physics"
    equation = "F_s rises by A (1 - exp(-t_d / tau)) after a rest of t_d"
    citation = "armstrong1994survey"
    says = "the breakaway torque grows with the time at rest"
    shown_at_rest = True
    like_a_bristle = True
    rest_speed: ClassVar[float] = 3e-3
    """Speed below which the contact ages [rad/s] or [m/s]."""
    least_rest: ClassVar[float] = 0.01
    """Part of the samples at rest below which the recording shows no ageing."""
    size_step: ClassVar[float] = 0.3
    """Change of the logarithm of a time or travel that matters."""
    times: ClassVar[tuple[float, float]] = (0.05, 60.0)
    """Bounds on the time constant [s]. A contact that ages faster has done so at every reversal, and one that takes a
    minute does not in a recording."""
    largest_rise: ClassVar[float] = 3.0
    """Largest rise in the Coulomb torque. Rests have been seen to raise static friction by as much as that torque
    itself."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # Travels below 1 mrad are the bristle's; above 0.1 rad the age outlasts most strokes.
        return (
            EffectParameter("rise", "{torque}", EFFECT.step * contexts[0].scale, form=0.4),
            replace(
                _build_size("time_constant", "s", self.times, prior=0.6, form=0.5),
                at_lowest="friction that is there after any rest, however short",
            ),
            _build_size("travel", "{position}", (1e-3, 0.1), prior=1.1, form=0.2),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Starts lie all over the bounds, since a sum of squares over two times of decay has several minima.
        sizes = [(t, d) for t in (0.3, 2.0, 10.0) for d in (2e-3, 1e-2)]
        return [{"time_constant": float(np.log(t)), "travel": float(np.log(d))} for t, d in sizes]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(level=values["rise"] * _compute_growth(context, values))

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        return ForwardPart(states=(_Age(context, values),))

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        rests = max(float(np.mean(np.abs(c.velocity) < self.rest_speed)) for c in contexts)
        return "the joint never rests" if rests < self.least_rest else None

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        if values["rise"] <= 0.0:
            return "the static friction would fall at rest"
        # Rests may be short beside the time constant.
        grown = max(float(np.max(_compute_growth(context, values))) for context in contexts)
        if values["rise"] * grown > self.largest_rise * contexts[0].plant.level:
            return "a rest would hold the joint with many times its sliding friction"
        return None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        time, travel = (float(np.exp(values[name])) for name in ("time_constant", "travel"))
        return DwellStictionTerm(values["rise"], time, travel, self.rest_speed)


class _Age(HiddenState):
    """Share of the rise that the rests of the simulated motion have brought, as `dwell` has it."""

    def __init__(self, context: Context, values: Values) -> None:
        self.context, self.values, self.rise = context, values, values["rise"]
        self.time, self.travel = np.exp(values["time_constant"]), float(np.exp(values["travel"]))

    def begin(self, sample: int, step: float) -> None:
        self.grown = float(_compute_growth(self.context, self.values)[sample])
        self.gain, self.per_speed = 1.0 - float(np.exp(-step / self.time)), step / self.travel

    def follow(self, velocity: float, friction: float) -> tuple[float, float]:
        if abs(velocity) < DwellStiction.rest_speed:
            self.grown += self.gain * (1.0 - self.grown)
        else:
            self.grown *= exp(-abs(velocity) * self.per_speed)
        return 0.0, self.rise * self.grown


def _compute_growth(context: Context, values: Values) -> FloatArray:
    """Share of the rise that rests have brought. Shape (n,)."""
    time, travel = np.exp(values["time_constant"]), np.exp(values["travel"])
    return dwell(context.velocity, np.array([context.dt, time, travel, DwellStiction.rest_speed]))


def _build_size(name: str, unit: str, limits: tuple[float, float], *, prior: float, form: float) -> EffectParameter:
    """A positive number that a recording may hardly fix, fitted as its logarithm."""
    low, high = (float(np.log(limit)) for limit in limits)
    known = (high - low) / (2.0 * 1.96)  # its domain, which starts may lie all over
    step = DwellStiction.size_step
    return EffectParameter(
        name, unit, step, low, high, linear=False, prior=prior, known=known, logarithmic=True, form=form
    )
