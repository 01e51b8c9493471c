"""A gap between the motor, where position is measured, and the load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register
from ..forward_part import ForwardPart
from ..settings import EFFECT
from ..two_masses import Transmission, compute_carried


@register
class Backlash(Effect):
    """J_l theta'' = K dz(q - theta, eps) - gravity [nordin2002]."""

    name = "backlash"
    kind = "physics"
    equation = "J_l theta'' = K dz(q - theta, eps) - gravity"
    citation = "nordin2002"
    says = "a gap lets the load go whenever the transmitted torque changes sign"
    shown_at_rest = True
    gap_step: ClassVar[float] = 0.4
    """Change of the logarithm of a gap that matters."""
    usual_rate: ClassVar[float] = 600.0
    """Rate of the load on the teeth once they touch, from which a fit starts [rad/s]: faster than rows can show."""
    rates: ClassVar[tuple[float, float]] = (60.0, 1500.0)
    """Bounds on that rate [rad/s]. A softer contact is a flexible transmission; a stiffer one shows no more."""
    usual_damping: ClassVar[float] = 0.5
    """Damping ratio of the load there, from which a fit starts: lubricated teeth are lossy."""
    dampings: ClassVar[tuple[float, float]] = (0.02, 2.0)
    """Bounds on it: from teeth that ring for some swings to those that stick."""
    contact_prior: ClassVar[float] = 1.0
    """Standard deviation of the logarithms of rate and damping ratio: joints differ by a factor of two or three."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A gap below 20 µrad is closed by any film of oil, and one above 30 mrad is seen with bare eyes.
        low, high = float(np.log(2e-5)), float(np.log(3e-2))
        step, prior = EFFECT.share_step, EFFECT.load_share_prior
        return (
            EffectParameter(
                "gap", "{position}", self.gap_step, low, high, linear=False, logarithmic=True, form=0.3, searched=True
            ),
            # MuJoCo's second hinge with a share of 0.587 was given 0.591.
            EffectParameter(
                "load_share", "1", step, *EFFECT.load_shares, linear=False, prior=prior, form=0.01, of_inertia=True
            ),
            self._build_contact("contact_rate", "1/s", self.rates),
            self._build_contact("contact_damping", "1", self.dampings),
        )

    def _build_contact(self, name: str, unit: str, limits: tuple[float, float]) -> EffectParameter:
        """A number of the teeth that touch, which few rows show, fitted as its logarithm."""
        low, high = (float(np.log(limit)) for limit in limits)
        return EffectParameter(
            name, unit, self.gap_step, low, high, linear=False, logarithmic=True, prior=self.contact_prior, form=0.5
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return self.recall_starts(contexts)

    def scan(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # The size of an impact is free within a factor of three; when it comes, the share tells within 0.02.
        gaps, shares = np.log(np.geomspace(1e-4, 2e-2, 6)), np.linspace(0.3, 0.94, 33)
        contact = {"contact_rate": float(np.log(self.usual_rate)), "contact_damping": float(np.log(self.usual_damping))}
        return [{"gap": float(gap), "load_share": float(share), **contact} for gap in gaps for share in shares]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(additive=compute_carried(context, _build_transmission(context, values)))

    def build_forward_part(self, context: Context, values: Values) -> ForwardPart:
        return ForwardPart(coupling=_build_transmission(context, values).build_coupling(context))

    def find_obstacle(self, contexts: Sequence[Context]) -> str | None:
        transmitted = [c.gravity + EFFECT.usual_load_share * c.plant.inertia * c.acceleration for c in contexts]
        crosses = max(int(np.sum(np.diff(np.sign(torque)) != 0)) for torque in transmitted)
        return "the transmitted torque never changes sign" if crosses < 2 else None


def _build_transmission(context: Context, values: Values) -> Transmission:
    inertia = context.plant.inertia * values["load_share"]
    gap, rate, damping = (float(np.exp(values[name])) for name in ("gap", "contact_rate", "contact_damping"))
    return Transmission(inertia, inertia * rate**2, damping, gap)
