"""A Stribeck curve whose fall is not Gaussian."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from fricomp.laws import FrictionLaw

from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, Values, register


@register
class StribeckShape(Effect):
    """F_c + (F_s - F_c) exp(-(|v|/v_s)^delta), delta other than 2 [bittencourt2010]."""

    name = "stribeck_shape"
    kind = "physics"
    equation = "F_c + (F_s - F_c) exp(-(|v|/v_s)^delta), delta other than 2"
    citation = "bittencourt2010"
    says = "the Stribeck curve falls with another exponent than two"
    form_of_friction = True
    tolerance: ClassVar[float] = 0.15
    """Distance from two within which the exponent is two: the curve differs by at most 2 % of its fall."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A curve with a smaller exponent hardly falls any more, and one with a larger falls in a step.
        return (
            EffectParameter("stribeck_exponent", "1", 0.2, 0.4, 4.0, linear=False, form=0.1, null=2.0, searched=True),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        return [{"stribeck_exponent": 1.0}, {"stribeck_exponent": 3.0}]

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        return Contribution(plant={"stribeck_exponent": values["stribeck_exponent"]})

    def is_in_law(self, law: FrictionLaw) -> bool:
        """Its exponent stands in the curves of every law."""
        return True

    def refuse(self, values: Values, contexts: Sequence[Context]) -> str | None:
        near = abs(values["stribeck_exponent"] - 2.0) < self.tolerance
        return "the exponent is two within its tolerance" if near else None
