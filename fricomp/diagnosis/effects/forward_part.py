"""What an effect is in a forward simulation, which has a motion of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

from ..joint.observer import Contribution
from .two_masses import Coupling


class HiddenState(ABC):
    """What friction remembers, advanced along the simulated motion."""

    @abstractmethod
    def begin(self, sample: int, step: float) -> None:
        """Take the state that the recorded motion has at `sample`; from there on steps are `step` [s] long."""

    @abstractmethod
    def follow(self, velocity: float, friction: float) -> tuple[float, float]:
        """Advance by a step at `velocity` [rad/s], under this friction torque [N·m].

        Returns:
            Torque that opposes the drive, and torque added to the dry friction level [N·m].
        """


@dataclass(frozen=True)
class ForwardPart:
    """What effects are in a forward simulation.

    Attributes:
        along: What they add along the recorded motion.
        states: What they remember of the simulated one.
        coupling: Load that moves on its own; None where it is rigidly joined.
    """

    along: Contribution = field(default_factory=Contribution)
    states: tuple[HiddenState, ...] = ()
    coupling: Coupling | None = None

    def __add__(self, other: ForwardPart) -> ForwardPart:
        both = [one for one in (self.coupling, other.coupling) if one is not None]
        coupling = both[0].join(both[1]) if len(both) == 2 else next(iter(both), None)
        return ForwardPart(self.along + other.along, self.states + other.states, coupling)
