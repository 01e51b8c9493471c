"""A flexible transmission between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution, Observer
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..forward_part import ForwardPart
from ..settings import EFFECT
from ..two_masses import Transmission, compute_carried


@register
class JointElasticity(Effect):
    """J_l theta'' = K (q - theta) + d (q' - theta') - gravity [spong1987]."""

    name = "joint_elasticity"
    kind = "physics"
    equation = "J_l theta'' = K (q - theta) + d (q' - theta') - gravity"
    citation = "spong1987"
    says = "the transmission is flexible"
    like_friction = True
    stiffness_step: ClassVar[float] = 0.2
    """Change of the logarithm of the stiffness that matters."""
    stiffness_form: ClassVar[float] = 0.15
    """Relative deviation that another form leaves in the stiffness. Below its resonance a spring shows over the
    square of the load's share: MuJoCo's were given 1 to 3 % too much, others up to 21 % too little."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A joint that swings at 15 rad/s sways visibly; at 1500 rad/s its spring is as stiff as a shaft, in usual rows.
        frequencies = 15.0, 1500.0 * _compare_rows(contexts)
        low, high = (float(np.log(contexts[0].plant.inertia * w**2)) for w in frequencies)
        return (
            EffectParameter(
                "stiffness",
                "{torque}/{position}",
                self.stiffness_step,
                low,
                high,
                linear=False,
                logarithmic=True,
                form=self.stiffness_form,
            ),
            # MuJoCo's second hinge with a share of 0.587 was given 0.594 to 0.609.
            EffectParameter(
                "load_share",
                "1",
                EFFECT.share_step,
                *EFFECT.load_shares,
                linear=False,
                prior=EFFECT.load_share_prior,
                form=0.025,
                of_inertia=True,
            ),
            # Damping from next to nothing to critical; a spring that hardens sixfold at its usual torque is a stop.
            EffectParameter("damping_ratio", "1", 0.3, -7.0, 0.0, linear=False, prior=1.0, logarithmic=True),
            EffectParameter("hardening", "1", 0.1, 0.0, 5.0, linear=False, prior=1.0),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.recall_starts(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Resonances that rows can show, 7 % apart: a fit goes to the nearest one.
        return _propose_resonances(contexts, np.geomspace(40.0, max(80.0, 500.0 * _compare_rows(contexts)), 40))

    def propose_far_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # As far apart as a careful fit reaches, 30 %.
        return _propose_resonances(contexts, np.geomspace(50.0, max(80.0, 300.0 * _compare_rows(contexts)), 8))

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=compute_carried(context, _build_transmission(context, values)))

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        return ForwardPart(coupling=_build_transmission(context, values).build_coupling(context))

    def doubt(self, values: Values, contexts: Sequence[Context]) -> str | None:
        highest = {one.name for one in self.list_parameters(contexts) if one.touches_end(values[one.name], low=False)}
        if "load_share" in highest:
            return "the motor would have no inertia"
        return "the spring would never swing" if "damping_ratio" in highest else None


def _build_transmission(context: Context, values: Values) -> Transmission:
    stiffness, ratio = (float(np.exp(values[name])) for name in ("stiffness", "damping_ratio"))
    return Transmission(context.plant.inertia * values["load_share"], stiffness, ratio, hardening=values["hardening"])


def _compare_rows(contexts: Sequence[Context]) -> float:
    """How fast things show in these rows, in what shows in usual ones."""
    return Observer().row_width / max(one.row_width for one in contexts)


def _propose_resonances(contexts: Sequence[Context], frequencies: FloatArray) -> list[dict[str, float]]:
    """A usual load on springs on which it swings at these frequencies [rad/s]."""
    share, ratio = EFFECT.usual_load_share, float(np.log(0.06))  # flexible gears are damped by some percent
    stiffness = np.log(share * contexts[0].plant.inertia * frequencies**2)
    return [{"stiffness": float(k), "load_share": share, "damping_ratio": ratio} for k in stiffness]
