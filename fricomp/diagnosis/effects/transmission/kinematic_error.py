"""A transmission error of the gear: the load runs ahead of and behind the motor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.laws import KINEMATIC_ERROR_TERMS, Term

from ...joint.observer import Contribution, Plant
from ..context import Context
from ..effect import Effect, EffectParameter, Values, compute_lowest_order, refuse_long_wave, register
from ..overtones import build_ripple_terms, get_overtone, list_multiples
from ..settings import EFFECT
from ..two_masses import compute_uneven_running


@register
class KinematicError(Effect):
    """tau = e' (gravity + 2 J_l a) + J_l e'' v² + gravity' e, with e = A sin(n q + phi) [tuttle1992]."""

    name = "kinematic_error"
    kind = "physics"
    equation = "tau = e' (gravity + 2 J_l a) + J_l e'' v² + gravity' e, e = A sin(n q + phi)"
    citation = "tuttle1992"
    says = "the gear runs unevenly, felt as a ripple that grows with the square of the speed"
    ripple = True

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # Gears run unevenly by some 0.1 mrad; by 0.1 rad no teeth would mesh.
        return (
            EffectParameter("sine", "{position}", 1e-4, -0.1, 0.1),
            EffectParameter("cosine", "{position}", 1e-4, -0.1, 0.1),
            EffectParameter("order", "1/{position}", EFFECT.order_step, compute_lowest_order(contexts), linear=False),
            EffectParameter(
                "load_share",
                "1",
                EFFECT.share_step,
                EFFECT.load_shares[0],
                1.0,
                linear=False,
                prior=0.2,
                of_inertia=True,
            ),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        lowest = compute_lowest_order(contexts)
        orders = contexts[0].hints.get("dynamic_order", ())
        return [{"order": n, "load_share": EFFECT.usual_load_share} for n in orders if n >= lowest]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        total = np.zeros_like(context.position)
        for times in list_multiples(values):
            order, (sine, cosine) = times * values["order"], get_overtone(values, times)
            torque = np.exp(1j * order * context.position)
            torque *= compute_uneven_running(context, order, values["load_share"])
            total += sine * torque.imag + cosine * torque.real
        return Contribution(additive=total)

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        slopes = [times * values["order"] * np.hypot(*get_overtone(values, times)) for times in list_multiples(values)]
        if max(slopes) > EFFECT.steepest_unevenness:
            return "the gear's ratio would change by more than half along a wave"
        return refuse_long_wave(values["order"], contexts)

    def build_terms(self, values: Values, plant: Plant, contexts: Sequence[Context]) -> tuple[Term, ...]:
        # The joint that the contribution was fitted along, which stays as it is while the plant is refitted.
        joint, rotary = contexts[0].plant, contexts[0].rotary
        gravity = joint.gravity if rotary else (0.0, 0.0)
        inertia = values["load_share"] * joint.inertia
        return build_ripple_terms(KINEMATIC_ERROR_TERMS, values, inertia, *gravity)
