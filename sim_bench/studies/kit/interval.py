"""Parameters whose true value is known, as a diagnosis gave them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class KnownInterval:
    """A parameter with its true value, in SI.

    Attributes:
        effect: The effect that it belongs to.
        parameter: Its name.
        truth: True value.
        value: As given.
        low: Lower end of the 95 % interval.
        high: Upper end.
    """

    effect: str
    parameter: str
    truth: float
    value: float
    low: float
    high: float

    @property
    def covers(self) -> bool:
        """Whether the interval holds the truth."""
        return self.low <= self.truth <= self.high

    @property
    def error(self) -> float:
        """How far the value lies from the truth, in half widths of the interval on that side; 1 is at its end."""
        end = self.high if self.truth > self.value else self.low
        return abs(self.truth - self.value) / max(abs(end - self.value), 1e-300)

    @property
    def relative_error(self) -> float:
        """|value / truth - 1|; NaN for a truth of 0."""
        return abs(self.value / self.truth - 1.0) if self.truth else float("nan")


def compare_parameters(effect: str, given: Mapping[str, Any], truth: Mapping[str, float]) -> tuple[KnownInterval, ...]:
    """All parameters of an effect that have an interval and a known true value.

    Parameters that the diagnosis holds fixed, and counts such as the order of a filter, have none and are left out.

    Args:
        effect: Its name.
        given: Its parameters, as a diagnosis gives them.
        truth: True values by name.
    """
    return tuple(
        KnownInterval(effect, name, truth[name], each["value"], *each["ci95"])
        for name, each in given.items()
        if name in truth and each["ci95"][0] < each["ci95"][1]
    )
