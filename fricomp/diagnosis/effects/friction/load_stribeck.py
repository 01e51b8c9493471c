"""Static friction that grows with the transmitted load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import LoadStribeck as LoadStribeckTerm
from fricomp.laws import Term
from fricomp.laws.stribeck import compute_falling_share

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..settings import EFFECT
from .load_share import SHARE, compute_felt_load, propose_shares


@register
class LoadStribeck(Effect):
    """c_ls |tau_l| exp(-(|v|/v_s)^delta) sgn(v), delta about 2 [duclusaud2025bam]."""

    name = "load_stribeck"
    kind = "physics"
    equation = "tau_f = c_ls |tau_l| exp(-(|v|/v_s)^delta) sgn(v)"
    citation = "duclusaud2025bam"
    shown_at_rest = True
    like_a_bristle = True
    says = "the extra friction of slow motion grows with the transmitted load"
    follows_load = True

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # Twice the load is more friction than a self-locking gear has; a little below zero shows that there is none.
        return (
            EffectParameter("coefficient", "{torque}/{torque}", EFFECT.small_step, -0.2, 2.0, form=0.15),
            EffectParameter("stribeck_exponent", "1", 0.2, 0.5, 4.0, linear=False, prior=0.5, form=0.1),
            SHARE,
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"stribeck_exponent": 2.0, **share} for share in propose_shares(contexts)]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        speed = np.abs(context.velocity)
        falling = compute_falling_share(speed, context.stribeck_velocity, values["stribeck_exponent"])
        return Contribution(level=values["coefficient"] * np.abs(compute_felt_load(context, values)) * falling)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        return "static friction would fall with load" if values["coefficient"] <= 0.0 else None

    def build_term(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> Term | None:
        speed = 0.5 * (plant.forward[2] + plant.reverse[2])
        return LoadStribeckTerm(values["coefficient"], speed, values["stribeck_exponent"])
