"""Descents of which only the best counts: which of them may still win, and which need no more steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .settings import JOINT


@dataclass
class Race:
    """Descents of which only the best counts: one that cannot come near it any more ends early.

    Attributes:
        start: Cost that all of them are to lower.
        lead: The lowest cost of any of them so far.
        at_once: End before the first step what cannot win. What starts far away has a long way to go first.
    """

    start: float
    lead: float = np.inf
    at_once: bool = False

    def is_lost(self, cost: float, promised: float) -> bool:
        """Whether a descent at `cost` stays far behind, even if it falls by several times what a line promises."""
        self.lead = min(self.lead, cost)
        bar = self.lead + JOINT.lost_share * max(self.start - self.lead, 0.0)
        return cost - JOINT.lost_promises * promised > bar

    def is_settled(self, cost: float, gain: float) -> bool:
        """Whether a descent at `cost` that fell by `gain` in its last step does not come to the leader any more."""
        return gain < JOINT.catching_up * (cost - self.lead)


@dataclass(frozen=True)
class Entry:
    """A descent in a race.

    Attributes:
        race: The race.
        hurried: Whether it ends as well where it has settled behind the leader, and its last digits do not matter.
    """

    race: Race
    hurried: bool = False
