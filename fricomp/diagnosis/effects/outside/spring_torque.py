"""A spring between the joint and its base, such as a cable bundle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from fricomp.laws import SpringTorque as SpringTorqueTerm
from fricomp.laws import Term

from ...inputs.track import SIMULATED_STIFFNESS
from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT


@register
class SpringTorque(Effect):
    """tau = k (x + h x^3), x = q - q_0."""

    name = "spring_torque"
    kind = "physics"
    equation = "tau = k (x + h x^3), x = q - q_0"
    citation = ""
    says = "a spring pulls the joint"
    shown_at_rest = True
    excess: ClassVar[float] = 0.1
    """Part of a spring which the joint lacks by which the fit may find more of it missing than the simulation has."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        scale = contexts[0].scale
        # A straight spring has its centre in the offset; only one that stiffens shows it. One that stiffens more than
        # fivefold at a radian is a stop.
        return (
            EffectParameter("stiffness", "{torque}/{position}", EFFECT.step * scale),
            EffectParameter("centre", "{position}", 0.2, -10.0, 10.0, linear=False, prior=0.5),
            EffectParameter("hardening", "1/{position}²", 0.1, 0.0, 5.0, linear=False, prior=0.5),
        )

    def propose_other_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # A spring that stiffens is a straight one and a change of gravity, but for the simulation's gravity.
        return [{"hardening": 0.2}]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        stretch = context.position - values["centre"]
        return Contribution(additive=values["stiffness"] * stretch * (1.0 + values["hardening"] * stretch**2))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        given = contexts[0].channels.get(SIMULATED_STIFFNESS)
        if given is None:
            return "the spring would push away from its centre" if values["stiffness"] <= 0.0 else None
        # Beside a simulation with a spring it is the difference: a joint without any shows less all of that one.
        least = -(1.0 + self.excess) * float(given[0])
        return "with the simulation's it would push away from its centre" if values["stiffness"] < least else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        return SpringTorqueTerm(values["stiffness"], values["centre"], values["hardening"])
