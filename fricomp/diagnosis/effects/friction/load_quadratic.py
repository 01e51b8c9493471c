"""Friction that curves with the transmitted load, or differs between driving and braking."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import FrictionLaw, LoadDriving, Term
from fricomp.laws import LoadQuadratic as LoadQuadraticTerm

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, PrintedForm, Values, register
from ..settings import EFFECT
from .load_share import SHARE, compute_felt_load, propose_shares


@register
class LoadQuadratic(Effect):
    """c_q tau_l^2 sgn(v), or c_d |tau_l| sgn(v) while the load drives [duclusaud2025bam]."""

    name = "load_quadratic"
    kind = "physics"
    equation = "tau_f = c_q tau_l^2 sgn(v), or c_d |tau_l| [tau_l v > 0] sgn(v)"
    citation = "duclusaud2025bam"
    says = "friction curves with the load, or differs between driving and braking"
    follows_load = True
    gain_share = 0.998  # One of its two forms is nearly that of `load_coulomb`.

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        largest = max(float(np.max(np.abs(c.load_torque))) for c in contexts) or 1.0
        return (
            EffectParameter("coefficient", "1/{torque}", EFFECT.small_step / largest, -1.0, 1.0),
            EffectParameter("split", "1", 0.0, 0.0, 1.0, linear=False),
            SHARE,
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"split": split, **share} for split in (0.0, 1.0) for share in propose_shares(contexts)]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        load = compute_felt_load(context, values)
        split = context.usual_load * np.abs(load) * (load * context.velocity > 0.0)
        return Contribution(level=values["coefficient"] * (split if values["split"] > 0.5 else load**2))

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        # Between driving and braking friction may differ either way.
        return "friction would fall with load" if values["split"] < 0.5 and values["coefficient"] <= 0.0 else None

    def choose_form(self, values: Values, contexts: Sequence[Context]) -> PrintedForm:
        curved, share = values["split"] < 0.5, {"inertia_share": (1.0, "1")}
        if curved:
            numbers = {"coefficient": (1.0, "1/{torque}"), **share}
            return PrintedForm("friction grows with the square of the load", "tau_f = c_q tau_l^2 sgn(v)", numbers)
        numbers = {"coefficient": (contexts[0].usual_load, "{torque}/{torque}"), **share}
        says = "friction under load differs between driving and braking"
        return PrintedForm(says, "tau_f = c_d |tau_l| [tau_l v > 0] sgn(v)", numbers)

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        if values["split"] < 0.5:
            return LoadQuadraticTerm(values["coefficient"])
        return LoadDriving(values["coefficient"] * contexts[0].usual_load)

    def is_in_law(self, law: FrictionLaw) -> bool:
        return any(term.name in (self.name, LoadDriving.name) for term in law.terms)
