"""Elastic presliding: a soft bristle that yields after a visible travel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fricomp.laws import FrictionLaw, LuGre

from ...joint.observer import Contribution
from ...joint.settings import JOINT
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class PreslidingHysteresis(Effect):
    """z' = v - sigma_0 |v| z / g(v), tau_f = sigma_0 z + sigma_1 z' [canudas1995lugre]."""

    name = "presliding_hysteresis"
    kind = "physics"
    equation = "z' = v - sigma_0 |v| z / g(v), tau_f = sigma_0 z + sigma_1 z'"
    citation = "canudas1995lugre"
    says = "after each reversal the friction builds up over a visible travel"
    shown_at_rest = True
    like_a_bristle = True
    least_distance: ClassVar[float] = 4e-4
    """Least breakaway distance [rad]; no joint has that much of itself."""
    largest_distance: ClassVar[float] = 5e-2
    """Largest breakaway distance [rad]; a joint that gives way by more than 3 degrees is on a spring."""
    distance_step: ClassVar[float] = 0.3
    """Change of the logarithm of that distance that matters."""
    near_softest: ClassVar[float] = 0.8
    """Part of the softest bristle that a base may have from which it is said to be at its bound."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        low, high = float(np.log(self.least_distance)), float(np.log(self.largest_distance))
        step = self.distance_step
        # A damping time is that of the base's own bristle; 50 ms of it would hold a joint like honey.
        return (
            EffectParameter(
                "breakaway_distance",
                "{position}",
                step,
                low,
                high,
                linear=False,
                logarithmic=True,
                form=0.15,
                searched=True,
            ),
            EffectParameter("damping_time", "s", 2e-3, 0.0, 0.05, linear=False),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Each start is some 2.5 times the last one, all over the bounds.
        return [{"breakaway_distance": float(np.log(d)), "damping_time": 0.0} for d in (6e-4, 1.5e-3, 4e-3, 1e-2)]

    def propose_far_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # Soft joints, whose base is bent so far that its columns say nothing.
        return [{"breakaway_distance": float(np.log(d)), "damping_time": 0.0} for d in (4e-3, 1.5e-2)]

    def is_suspected(self, contexts: Sequence[Context]) -> bool:
        """The base's own bristle is as soft as it may be."""
        plant = contexts[0].plant
        return plant.bristle_level / plant.sigma_0 > self.near_softest * JOINT.softest_bristle

    def is_in_law(self, law: FrictionLaw) -> bool:
        return any(isinstance(term, LuGre) for term in law.terms)

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        sigma_0 = context.plant.bristle_level / float(np.exp(values["breakaway_distance"]))
        return Contribution(plant={"sigma_0": sigma_0, "sigma_1": sigma_0 * values["damping_time"]})
