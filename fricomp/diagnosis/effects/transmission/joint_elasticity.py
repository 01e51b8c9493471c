"""A flexible transmission between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...inputs.track import FloatArray
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..forward_part import ForwardPart
from ..two_masses import Transmission, compute_carried


@register
class JointElasticity(Effect):
    """J_l theta'' = K (q - theta) + d (q' - theta') - gravity [spong1987]."""

    name = "joint_elasticity"
    kind = "physics"
    equation = "J_l theta'' = K (q - theta) + d (q' - theta') - gravity"
    citation = "spong1987"
    says = "the transmission is flexible"
    stiffness_form: ClassVar[float] = 0.15
    """Relative deviation that another form leaves in the stiffness. Below its resonance a spring shows over the
    square of the load's share: MuJoCo's were given 1 to 3 % too much, others up to 21 % too little."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        low, high = (float(np.log(contexts[0].plant.inertia * w**2)) for w in (15.0, 1500.0))
        return (
            EffectParameter(
                "stiffness",
                "{torque}/{position}",
                0.2,
                low,
                high,
                linear=False,
                logarithmic=True,
                form=self.stiffness_form,
            ),
            # MuJoCo's second hinge with a share of 0.587 was given 0.594 to 0.609.
            EffectParameter("load_share", "1", 0.1, 0.05, 0.98, linear=False, prior=0.3, form=0.025),
            EffectParameter("damping_ratio", "1", 0.3, -7.0, 0.0, linear=False, prior=1.0, logarithmic=True),
            EffectParameter("hardening", "1", 0.1, 0.0, 5.0, linear=False, prior=1.0),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.recall_starts(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return _propose_resonances(contexts, np.geomspace(40.0, 500.0, 40))

    def propose_far_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return _propose_resonances(contexts, np.geomspace(50.0, 300.0, 8))

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=compute_carried(context, _build_transmission(context, values)))

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        return ForwardPart(coupling=_build_transmission(context, values).build_coupling(context))


def _build_transmission(context: Context, values: Values) -> Transmission:
    stiffness, ratio = (float(np.exp(values[name])) for name in ("stiffness", "damping_ratio"))
    return Transmission(context.plant.inertia * values["load_share"], stiffness, ratio, hardening=values["hardening"])


def _propose_resonances(contexts: Sequence[Context], frequencies: FloatArray) -> list[dict[str, float]]:
    """A usual load on springs on which it swings at these frequencies [rad/s]."""
    share, ratio = 0.6, float(np.log(0.06))
    stiffness = np.log(share * contexts[0].plant.inertia * frequencies**2)
    return [{"stiffness": float(k), "load_share": share, "damping_ratio": ratio} for k in stiffness]
