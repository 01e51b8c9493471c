"""The external disturbance tau_d(t) of equation (1): torque on a joint that no model of it explains."""

from dataclasses import dataclass
from math import pi, sin


@dataclass(frozen=True)
class Sinusoid:
    """amplitude sin(2 pi frequency t + phase).

    Attributes:
        amplitude: [N·m] or [N].
        frequency: [Hz].
        phase: [rad].
    """

    amplitude: float
    frequency: float
    phase: float = 0.0


@dataclass(frozen=True)
class Disturbance:
    """A sum of sinusoids on one joint; none by default.

    Attributes:
        sinusoids: Its parts.
    """

    sinusoids: tuple[Sinusoid, ...] = ()

    def torque(self, time: float) -> float:
        """Torque at `time` [s], [N·m] or [N]."""
        return sum(s.amplitude * sin(2.0 * pi * s.frequency * time + s.phase) for s in self.sinusoids)
