"""When a plateau has settled: the mean speed of some windows in a row is what was asked for."""

from __future__ import annotations

from math import isfinite

__all__ = ["SettleDetector"]

# Consecutive windows that must agree, their tolerance, and the encoder counts a window must hold so that
# quantisation alone stays inside it.
WINDOWS = 4
TOLERANCE = 0.04
COUNTS = 60


class SettleDetector:
    """Watches the position while a joint follows a constant velocity.

    Args:
        velocity: Reference [rad/s] or [m/s].
        quantum: Step of the encoder [rad] or [m].
        window: Shortest window [s].
    """

    def __init__(self, velocity: float, quantum: float, window: float = 0.025) -> None:
        self._velocity = velocity
        self._window = max(window, COUNTS * quantum / abs(velocity) / WINDOWS)
        self._since = float("nan")
        self._from = 0.0
        self._agreed = 0

    def update(self, time: float, position: float) -> bool:
        """Take a sample; whether the plateau has settled.

        Args:
            time: [s].
            position: [rad] or [m].
        """
        if not isfinite(self._since):
            self._since, self._from = time, position
        elif time - self._since >= self._window:
            mean = (position - self._from) / (time - self._since)
            close = abs(mean - self._velocity) <= TOLERANCE * abs(self._velocity)
            self._agreed = self._agreed + 1 if close else 0
            self._since, self._from = time, position
        return self._agreed >= WINDOWS
