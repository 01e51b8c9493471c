"""One visit to a plateau: the reference of every cycle, and from when to when it counts."""

from math import inf, isfinite

from ..planning.plan import Plateau
from ..planning.settling import SettleDetector

__all__ = ["PlateauVisit"]

# Cycles before a plateau's end that are left out of it, so that nothing of the ramp gets into its means.
EDGE = 5
# Encoder counts after which a joint has come loose, and the longest wait for that: a soft loop takes its time until
# it pulls hard enough, and only then does settling begin [s].
LOOSE = 2
LONGEST_STICK = 10.0


class PlateauVisit:
    """Told the newest position every cycle, gives the reference.

    Args:
        plateau: Which.
        quantum: Step of the encoder [rad] or [m].
        period: Of the loop [s].
        position: Where the joint rests [rad] or [m].

    Attributes:
        settled: Whether settling was seen.
        start_ns: Feedback time from which the plateau counts [ns].
        stop_ns: Feedback time at which it ends [ns].
    """

    def __init__(self, plateau: Plateau, quantum: float, period: float, position: float) -> None:
        self._plateau, self._period = plateau, period
        self._detector = SettleDetector(plateau.velocity, quantum, period)
        self._loose = LOOSE * quantum + 1e-9
        self._rest = position
        self._stuck: float | None = None
        self._end = inf
        self.settled = False
        self.start_ns = self.stop_ns = 0

    def velocity_at(self, time: float, feedback_ns: int, position: float) -> float | None:
        """Reference at `time` [s] after the start [rad/s] or [m/s]; None once the joint is to rest again.

        Args:
            time: Since the start of the motion [s].
            feedback_ns: When the newest position was taken [ns].
            position: The newest [rad] or [m].
        """
        velocity, ramp = self._plateau.velocity, self._plateau.ramp
        if time >= ramp and not isfinite(self._end):
            self._await_settling(time, feedback_ns, position)
        if time >= self._end - EDGE * self._period and not self.stop_ns:
            self.stop_ns = feedback_ns
        if time < self._end:
            return velocity * min(1.0, time / ramp)
        return velocity * (1.0 - (time - self._end) / ramp) if time < self._end + ramp else None

    def _await_settling(self, time: float, feedback_ns: int, position: float) -> None:
        """Let the plateau begin once it has settled, or has taken too long."""
        late = time - self._plateau.ramp
        if self._stuck is None:
            if abs(position - self._rest) <= self._loose and late < LONGEST_STICK:
                return
            self._stuck = late
        self.settled = self._detector.update(feedback_ns * 1e-9, position)
        if self.settled or late - self._stuck >= self._plateau.settle:
            self._end, self.start_ns = time + self._plateau.dwell, feedback_ns
