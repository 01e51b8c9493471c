"""Every number that decides which model is handed over, with its reason."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DeliverySettings:
    """How models are settled and drawn.

    Attributes:
        as_good: Part by which the error of a model may exceed that of its refit, so that its numbers stay: they are the
            ones that the answer prints, with their intervals.
        same_gravity: The same where gravity alone stays. Over a small angle it trades with a difference of the
            directions, of which a simulation of the reversals as well, as the answer is found by, knows more.
        drawn: Samples of a drawn error, in bands: fewer would not show it, more say the same.
    """

    as_good: float = 0.01
    same_gravity: float = 0.1
    drawn: float = 3.0


DELIVERY = DeliverySettings()
