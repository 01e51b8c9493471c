"""Friction that falls as the joint warms."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, expm1

import numpy as np

from fricomp.laws import Term
from fricomp.laws import ThermalFriction as ThermalFrictionTerm
from fricomp.laws.thermal_friction import STRONGEST_FALL
from fricomp.root_mean_square import compute_rms

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..forward_part import ForwardPart, HiddenState
from ..heating_time import HEATING_TIME, propose_heating_times
from ..settings import EFFECT
from ..warming import compute_heat, compute_unit_rise, warm_by_losses

LEAST_VISCOUS = 0.1
"""Least viscous friction at top speed in the dry level: what warms must be something, also where a base found none."""

STEADY_SHARE = EffectParameter("steady_share", "1", 0.2, 0.0, 1.0, linear=False, prior=0.5)
"""Part of the mean losses that warms the joint at any time, whatever its friction does [1]: a motor that holds a load
and a housing that warms from outside do."""


@register
class ThermalFriction(Effect):
    """tau_f = F_v exp(-beta dT) v + F_c (1 - gamma dT) sgn(v) [simoni2015]."""

    name = "thermal_friction"
    kind = "physics"
    equation = "tau_f = F_v exp(-beta dT) v + F_c (1 - gamma dT) sgn(v)"
    citation = "simoni2015"
    says = "friction changes with the temperature of the joint"

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        viscous = max(max(c.plant.forward[3], c.plant.reverse[3]) for c in contexts)
        heat = max(float(np.max(np.abs(compute_heat(c, EFFECT.heating_starts[1])))) for c in contexts)
        largest = heat if heat > 0.0 else 1.0  # without heating the columns are zero, whatever their scale
        recorded = _is_recorded(contexts)
        per_kelvin = "/K" if recorded else ""
        slope = EFFECT.step * (viscous + LEAST_VISCOUS * contexts[0].scale) / largest
        level = EFFECT.step * contexts[0].scale / largest
        slopes = (
            EffectParameter("viscous_slope", "{torque}·s/{position}" + per_kelvin, slope),
            EffectParameter("coulomb_slope", "{torque}" + per_kelvin, level),
        )
        return slopes if recorded else (*slopes, HEATING_TIME, STEADY_SHARE)

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        if _is_recorded(contexts):
            return [{}]
        return [{**one, STEADY_SHARE.name: 0.5} for one in propose_heating_times()]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        heat = compute_heat(context, _read_time_constant(values), values.get(STEADY_SHARE.name, 0.0))
        viscous = np.where(context.velocity >= 0.0, *_bound_viscous(context))
        fall = np.clip(values["viscous_slope"] * heat / viscous, -STRONGEST_FALL, STRONGEST_FALL)
        return Contribution(
            additive=viscous * np.expm1(-fall) * context.velocity, level=-values.get("coulomb_slope", 0.0) * heat
        )

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        if "temperature" in context.channels:
            return super().build_forward_part(context, values)
        return ForwardPart(states=(_Warmth(context, values),))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        speed = max(compute_rms(c.velocity) for c in contexts)
        rises = values["viscous_slope"] * speed + values.get("coulomb_slope", 0.0) <= 0.0
        return "friction would rise with temperature" if rises else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        if not _is_recorded(contexts):
            return None  # the estimate follows from all friction since the joint was cold, and no term knows either
        slopes = values["viscous_slope"], values["coulomb_slope"]
        return ThermalFrictionTerm(*_bound_viscous(contexts[0]), *slopes, contexts[0].usual_temperature)


def _bound_viscous(context: Context) -> tuple[float, float]:
    """Viscous friction of both directions that the heat changes, held above nothing [N·m·s/rad]."""
    least = LEAST_VISCOUS * context.scale / max(float(np.max(np.abs(context.velocity))), 1e-9)
    return max(context.plant.forward[3], least), max(context.plant.reverse[3], least)


class _Warmth(HiddenState):
    """The temperature that the losses of the simulated motion bring, as `compute_heat` estimates it."""

    def __init__(self, context: Context, values: Values) -> None:
        self.context, self.slope, self.time_constant = context, values["viscous_slope"], _read_time_constant(values)
        self.forward, self.reverse = _bound_viscous(context)
        self.steady = values.get(STEADY_SHARE.name, 0.0)
        self.level = values.get("coulomb_slope", 0.0)

    def begin(self, sample: int, step: float) -> None:
        warming = warm_by_losses(self.context, self.time_constant, self.steady)
        self.rise, self.usual, self.mean = float(warming.rise[sample]), warming.usual, warming.unit
        self.gain, self.unit = 1.0 - exp(-step / self.time_constant), compute_unit_rise(self.time_constant)

    def follow(self, velocity: float, friction: float) -> tuple[float, float]:
        losses = (1.0 - self.steady) * abs(friction * velocity) / self.mean + self.steady
        self.rise += self.gain * (losses - self.rise)
        viscous = self.forward if velocity >= 0.0 else self.reverse
        fall = min(max(self.slope * (self.rise - self.usual) / self.unit / viscous, -STRONGEST_FALL), STRONGEST_FALL)
        return viscous * expm1(-fall) * velocity, -self.level * (self.rise - self.usual) / self.unit


def _read_time_constant(values: Values) -> float:
    """Of the estimated temperature [s]."""
    return float(np.exp(values.get("time_constant", 0.0)))


def _is_recorded(contexts: Sequence[Context]) -> bool:
    """Whether the temperature stands in every recording."""
    return all("temperature" in context.channels for context in contexts)
