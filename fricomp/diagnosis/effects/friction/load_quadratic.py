"""Friction that curves with the transmitted load, or differs between driving and braking."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import FrictionLaw, LoadCoulomb, LoadDriving, Term
from fricomp.laws import LoadQuadratic as LoadQuadraticTerm

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, PrintedForm, Values, register
from ..identity import BRAKING, DRIVING
from ..settings import EFFECT
from .load_share import SHARE, compute_felt_load, propose_shares

_SQUARE = 0
"""The form beside `DRIVING` and `BRAKING`, as a value of `split`."""


@register
class LoadQuadratic(Effect):
    """c_q tau_l^2 sgn(v), or c |tau_l| sgn(v) while the joint drives the load or brakes it alone [duclusaud2025bam]."""

    name = "load_quadratic"
    kind = "physics"
    equation = "tau_f = c_q tau_l^2 sgn(v), or c_d |tau_l| [tau_l v > 0] sgn(v), or c_b |tau_l| [tau_l v < 0] sgn(v)"
    citation = "duclusaud2025bam"
    says = "friction curves with the load, or differs between driving and braking"
    follows_load = True
    gain_share = 0.99  # Two of its forms are nearly that of `load_coulomb`, the usual law.

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        largest = max(float(np.max(np.abs(c.load_torque))) for c in contexts) or 1.0
        return (
            EffectParameter("coefficient", "1/{torque}", EFFECT.small_step / largest, -1.0, 1.0),
            EffectParameter("split", "1", 0.0, _SQUARE, BRAKING, linear=False),
            SHARE,
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"split": float(form), **share} for form in (_SQUARE, DRIVING) for share in propose_shares(contexts)]

    def propose_other_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Beside a base that is free, what brakes is what drives the other way round and another gravity and inertia.
        share = propose_shares(contexts)[0]
        return [{"split": float(form), **share} for form in (BRAKING, DRIVING, _SQUARE)]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        load = compute_felt_load(context, values)
        form = round(values["split"])
        if form == _SQUARE:
            return Contribution(level=values["coefficient"] * load**2)
        acts = load * context.velocity > 0.0 if form == DRIVING else load * context.velocity < 0.0
        return Contribution(level=values["coefficient"] * context.usual_load * np.abs(load) * acts)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        # Between driving and braking friction may differ either way.
        falls = round(values["split"]) == _SQUARE and values["coefficient"] <= 0.0
        return "friction would fall with load" if falls else None

    def choose_form(self, values: Values, contexts: Sequence[Context]) -> PrintedForm:
        share, form = {"inertia_share": (1.0, "1")}, round(values["split"])
        if form == _SQUARE:
            numbers = {"coefficient": (1.0, "1/{torque}"), **share}
            return PrintedForm("friction grows with the square of the load", "tau_f = c_q tau_l^2 sgn(v)", numbers)
        numbers = {"coefficient": (contexts[0].usual_load, "{torque}/{torque}"), **share}
        says = "friction under load differs between driving and braking"
        acts = "c_d |tau_l| [tau_l v > 0]" if form == DRIVING else "c_b |tau_l| [tau_l v < 0]"
        return PrintedForm(says, f"tau_f = {acts} sgn(v)", numbers)

    def build_terms(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> tuple[Term, ...]:
        if round(values["split"]) == _SQUARE:
            return (LoadQuadraticTerm(values["coefficient"]),)
        coefficient = values["coefficient"] * contexts[0].usual_load
        if round(values["split"]) == DRIVING:
            return (LoadDriving(coefficient),)
        return (LoadCoulomb(coefficient), LoadDriving(-coefficient))

    def is_in_law(self, law: FrictionLaw) -> bool:
        return any(term.name in (self.name, LoadDriving.name) for term in law.terms)
