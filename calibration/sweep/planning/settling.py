"""When a plateau has settled: the mean speed of some windows in a row is what was asked for."""

from math import isfinite

__all__ = ["SettleDetector", "longest_settling"]

# Consecutive windows that must agree, their tolerance, and the encoder counts that all of them hold together. A window
# ends where the encoder counts, so that it is known to a sample and not only to a count.
WINDOWS = 4
TOLERANCE = 0.04
COUNTS = 32
SHORTEST = 0.025  # window [s]


def longest_settling(speed: float, quantum: float) -> float:
    """Time within which even a coarse encoder shows that a plateau has settled, four times over [s].

    Args:
        speed: [rad/s] or [m/s].
        quantum: Step of the encoder [rad] or [m].
    """
    return 4.0 * COUNTS * quantum / speed


class SettleDetector:
    """Watches the position while a joint follows a constant velocity.

    Args:
        velocity: Reference [rad/s] or [m/s].
        quantum: Step of the encoder [rad] or [m].
        period: Between samples [s].
    """

    def __init__(self, velocity: float, quantum: float, period: float) -> None:
        self._velocity, self._period = velocity, period
        count = quantum / abs(velocity)
        # The end of a window is known to a count or to a sample, whichever is the finer.
        self._window = max(SHORTEST, COUNTS * count / WINDOWS, min(count, period) / (0.5 * TOLERANCE))
        self._since = float("nan")
        self._from = self._last = 0.0
        self._time = self._late = 0.0
        self._agreed = 0

    def update(self, time: float, position: float) -> bool:
        """Take a sample; whether the plateau has settled.

        A sample that comes late may be as old as it is late, which widens the tolerance of the windows it bounds.

        Args:
            time: [s].
            position: [rad] or [m].
        """
        late = max(time - self._time - 1.5 * self._period, 0.0) if self._time else 0.0
        self._time = time
        if not isfinite(self._since):
            self._since, self._from, self._late = time, position, late
        elif position != self._last and time - self._since >= self._window:
            elapsed = time - self._since
            mean = (position - self._from) / elapsed
            tolerance = TOLERANCE + (late + self._late) / elapsed
            close = abs(mean - self._velocity) <= tolerance * abs(self._velocity)
            self._agreed = self._agreed + 1 if close else 0
            self._since, self._from, self._late = time, position, late
        self._last = position
        return self._agreed >= WINDOWS
