"""A drive whose torque follows its command through a low pass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from ...joint.base import is_at_earliest
from ...joint.observer import Contribution
from ..context import Context
from ..effect import Effect, EffectParameter, PrintedForm, Values, register


@register
class DriveLag(Effect):
    """tau = tau_command / (1 + T s / n)^n, n = 1 or 2, or with less damping [hollerbach2016]."""

    name = "drive_lag"
    kind = "measurement"
    equation = "tau = tau_command / (1 + T s / n)^n"
    citation = "hollerbach2016"
    says = "the torque that acts follows the recorded one through a low pass"
    like_friction = True
    forms: ClassVar[tuple[tuple[float, float], ...]] = ((1.0, 1.0), (2.0, 1.0), (2.0, 0.7))
    """Order n of the low pass and its damping ratio D: once or twice the first order, and as loops are tuned that
    hardly overshoot."""
    shortest_lag: ClassVar[float] = 1e-6
    """Time constant below which the low pass is left out [s]; it only keeps the filter from dividing by nothing."""

    def list_parameters(self, contexts: Sequence[Context]) -> tuple[EffectParameter, ...]:
        # A lag of more than 50 ms spans a whole row: what is slower is no low pass of a drive.
        return (
            EffectParameter(
                "time_constant", "s", 2e-3, 0.0, 0.05, linear=False, form=0.05, with_delay=1.0, null=0.0, searched=True
            ),
            EffectParameter("order", "1", 0.0, 1.0, 2.0, linear=False),
            EffectParameter("damping_ratio", "1", 0.0, 0.5, 1.0, linear=False),
        )

    def propose_starts(self, contexts: Sequence[Context]) -> list[dict[str, float]]:
        # All forms of the filter, each from a lag of some samples and from one of a row's part.
        return [
            {"time_constant": lag, "order": order, "damping_ratio": damping}
            for lag in (2e-3, 6e-3)
            for order, damping in self.forms
        ]

    def is_suspected(self, contexts: Sequence[Context]) -> bool:
        """The torque of the base is recorded as early as it may be."""
        return is_at_earliest(contexts[0].plant, contexts[0].delays[0])

    def compute_contribution(self, context: Context, values: Values) -> Contribution:
        """The recorded torque itself is filtered: where the joint sticks, the torque that a base without the lag needs
        is another one.
        """
        if values["time_constant"] < self.shortest_lag:
            return Contribution()
        lag, damping = values["time_constant"], values["damping_ratio"]
        if round(values["order"]) == 1:
            return Contribution(lags=(lag,))
        if damping >= 1.0:
            return Contribution(lags=(0.5 * lag,) * 2)
        half = 0.5 * lag * complex(1.0, np.sqrt(damping**-2.0 - 1.0))
        return Contribution(lags=(half, half.conjugate()))

    def choose_form(self, values: Values, contexts: Sequence[Context]) -> PrintedForm:
        numbers = {"time_constant": (1.0, "s"), "order": (1.0, "1")}
        if values["damping_ratio"] >= 1.0:
            return PrintedForm(self.says, self.equation, numbers)
        damped = "tau = tau_command / (1 + T s + (T s / (2 D))^2)"
        return PrintedForm(self.says, damped, {**numbers, "damping_ratio": (1.0, "1")})
