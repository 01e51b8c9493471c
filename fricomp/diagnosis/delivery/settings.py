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
        window: Length of the stretches in which the error is looked at over a long recording [s].
        window_moves: Part of it in which the joint has to move for that.
        clearly_moves: Part of the top speed from which rows count there. Slower ones may be about to stick, where a
            written model is off by much for moments.
        stands_out: Times the usual error of such a stretch from which one is told. Chance and motion make 1.2.
        most_standing_out: Part of the stretches up to which they are told by their times.
    """

    as_good: float = 0.01
    same_gravity: float = 0.1
    drawn: float = 3.0
    window: float = 10.0
    window_moves: float = 0.1
    clearly_moves: float = 0.05
    stands_out: float = 3.0
    most_standing_out: float = 0.2


DELIVERY = DeliverySettings()
