"""What the safety gate latches on: a reason, and the value with its limit in words."""

from dataclasses import dataclass
from typing import Literal

TripReason = Literal[
    "not_finite",
    "absurd_command",
    "wrong_joint_count",
    "overspeed",
    "position_limit",
    "overtemperature",
    "overtorque",
    "jump",
    "contradiction",
    "frozen",
    "runaway",
    "stale",
    "drive_fault",
    "link",
    "overrun",
    "stop",
    "exception",
]
"""Why the gate latched."""


@dataclass(frozen=True)
class TripRecord:
    """The first trip since the last reset.

    Attributes:
        reason: What kind of trip it was.
        detail: The value and the limit, in words.
        time_ns: When, on the adapter's clock; None where the caller did not say [ns].
    """

    reason: TripReason
    detail: str
    time_ns: int | None = None

    def __str__(self) -> str:
        return f"{self.reason.replace('_', ' ')}: {self.detail}"
