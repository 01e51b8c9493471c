"""Virtual time: a control loop that sleeps lets the simulation run."""

from .stand_in import StandIn


class LockStepClock:
    """The clock of a stand-in: `sleep_until` steps it, nothing else moves it.

    Args:
        stand_in: What is stepped.
    """

    is_lock_step = True

    def __init__(self, stand_in: StandIn) -> None:
        self._stand_in = stand_in

    def now_ns(self) -> int:
        """Simulated time [ns]."""
        return self._stand_in.time_ns

    def sleep_until(self, deadline_ns: int) -> None:
        """Step until the simulated time is at or past `deadline_ns` [ns]."""
        stand_in = self._stand_in
        while stand_in.time_ns < deadline_ns:
            stand_in.step()
