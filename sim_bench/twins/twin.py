"""A drive twin: a device that speaks a drive's protocol with a simulated joint behind it."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

from ..stand_in import StandIn

__all__ = ["DriveTwin", "TwinClock", "TwinServer"]

# How long a server sleeps when nothing has come [s].
IDLE_SLEEP = 0.0002
# A server that falls further behind than this gives the time up as lost [s].
LARGEST_LAG = 0.1


class DriveTwin(ABC):
    """Answers frames as they come (`pump`) and lets time pass (`step`); safe to use from several threads.

    Args:
        stand_in: The joints behind the drives.
        drives: One for each joint.
    """

    drives: tuple[Any, ...]

    def __init__(self, stand_in: StandIn, drives: Sequence[Any]) -> None:
        self.stand_in, self.drives = stand_in, tuple(drives)
        self.unplugged = False
        """While true, nothing is received and nothing sent: the cable is out."""
        self._guard = threading.RLock()

    def pump(self) -> int:
        """Answer what has come; returns how many frames or bytes that was."""
        with self._guard:
            return self._pump()

    def step(self) -> None:
        """Answer what has come, advance the joints by one period, and send what is due."""
        with self._guard:
            self._pump()
            self.advance()

    def advance(self) -> None:
        """Advance the joints by one period and send what is due; nothing is answered."""
        with self._guard:
            self.stand_in.step()
            self._tick(self.stand_in.time_ns)

    def power_cycle(self) -> None:
        """Switch off and on: every drive is as it was delivered, and de-energised."""
        with self._guard:
            self._power_cycle()

    @abstractmethod
    def close(self) -> None:
        """Let go of the bus or port."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def _pump(self) -> int:
        """Receive and answer."""

    def _tick(self, now_ns: int) -> None:
        """Watchdogs and periodic frames at simulated time `now_ns` [ns]."""
        for drive in self.drives:
            drive.tick(now_ns)

    def _power_cycle(self) -> None:
        """Forget everything that is not stored."""
        for drive in self.drives:
            drive.power_cycle()


class TwinClock:
    """Virtual time of a twin for an adapter in the same process: sleeping lets the twin run, in lock step."""

    is_lock_step = True

    def __init__(self, twin: DriveTwin) -> None:
        self._twin = twin

    def now_ns(self) -> int:
        """Simulated time [ns]."""
        return self._twin.stand_in.time_ns

    def sleep_until(self, deadline_ns: int) -> None:
        """Step the twin until the simulated time is at or past `deadline_ns` [ns]."""
        twin = self._twin
        while twin.stand_in.time_ns < deadline_ns:
            twin.step()
        twin.pump()


class TwinServer:
    """A thread that answers for a twin; with `real_time` it also lets the joints move with the wall clock.

    Without it only requests are answered, and time passes through `TwinClock`: blocking set-up conversations
    (SDO, register reads) work while the motion stays in lock step.

    Args:
        twin: The twin to serve.
        real_time: Whether the joints follow the wall clock.
    """

    def __init__(self, twin: DriveTwin, *, real_time: bool = False) -> None:
        self._twin, self._real_time = twin, real_time
        self._stop = threading.Event()
        self.error: BaseException | None = None
        """What ended the thread, if it was not `__exit__`."""
        self._thread = threading.Thread(target=self._run, name="drive-twin", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._thread.join(timeout=2.0)

    def wait(self) -> None:
        """Serve until the thread ends or is interrupted."""
        while self._thread.is_alive():
            self._thread.join(timeout=0.2)

    def _run(self) -> None:
        try:
            self._serve()
        except BaseException as error:  # handed to the owner: a thread has nobody to raise to
            self.error = error

    def _serve(self) -> None:
        due = time.monotonic()
        while not self._stop.is_set():
            if self._real_time:
                due = self._catch_up(due)
            if not self._twin.pump():
                time.sleep(IDLE_SLEEP)

    def _catch_up(self, due: float) -> float:
        """Let the joints move until now; gives the time of the next period [s].

        Before anything is answered: a real drive goes on where this process is halted, and tells where it is, not where
        it was. A state that is older than its answer would look like a jump.
        """
        period = self._twin.stand_in.settings.period
        due = max(due, time.monotonic() - LARGEST_LAG)
        for _ in range(round(LARGEST_LAG / period)):  # a machine that is slower than the joint has to be answered, too
            if due > time.monotonic():
                break
            self._twin.advance()
            due += period
        return due
