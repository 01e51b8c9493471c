"""The half that all adapters over a link share: holding the link, pumping it, waiting for an answer."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar, final

from fricomp.errors import AdapterConnectionError, AdapterTimeout
from fricomp.joint import Clock, JointFeedback

from .adapter import JointAdapter
from .arrivals import Arrivals
from .options import AdapterOptions

__all__ = ["POLL_INTERVAL", "LinkAdapter"]

POLL_INTERVAL = 0.0005
"""How often the link is looked at while waiting for an answer [s]."""


class AnyLink(Protocol):
    """What CAN buses and serial ports have in common."""

    def discard_output(self) -> None:
        """Drop what still waits to be sent."""

    def close(self) -> None:
        """Let go."""


Link = TypeVar("Link", bound=AnyLink)


class LinkAdapter(JointAdapter, Generic[Link]):
    """N drives behind one link. Received in the control thread only; any thread may send.

    Args:
        options: Limits and transmissions.
        open_link: Makes the link; called by `open`.
        clock: Real time unless a simulation brings its own.
        parts: Messages that make up the state of one joint.
    """

    def __init__(
        self, options: AdapterOptions, open_link: Callable[[], Link], clock: Clock | None = None, *, parts: int = 1
    ) -> None:
        super().__init__(options, clock)
        self._open_link = open_link
        self._link: Link | None = None
        self._arrivals = Arrivals(parts * len(options.limits))
        self._reported = JointFeedback(len(options.limits))
        self.n_damaged = 0

    @abstractmethod
    def _pump(self) -> None:
        """Take in everything that has come: mark `_arrivals`, fill `_reported`; ignore what is foreign or damaged."""

    @final
    def _connect(self) -> None:
        self._link = self._open_link()
        self._pump()  # what an earlier owner of the bus left behind

    @property
    @final
    def _opened_link(self) -> Link:
        if self._link is None:
            raise AdapterConnectionError("the bus is not open")
        return self._link

    @final
    def _discard_output(self) -> None:
        if self._link is not None:
            self._link.discard_output()

    @final
    def _wait(self, condition: Callable[[], bool], seconds: float, complaint: str) -> None:
        """Pump until `condition` holds.

        Raises:
            AdapterTimeout: It does not within `seconds` of the adapter's clock.
        """
        deadline = self.clock.now_ns() + round(seconds * 1e9)
        while True:
            self._pump()
            if condition():
                return
            now = self.clock.now_ns()
            if now >= deadline:
                raise AdapterTimeout(f"{complaint} within {seconds:g} s")
            self.clock.sleep_until(now + round(POLL_INTERVAL * 1e9))

    @final
    def _take_reported(self, feedback: JointFeedback) -> bool:
        """Hand over the drives' state if all have reported anew; the lists themselves, which nobody else changes."""
        if not self._arrivals.take():
            return False
        source = self._reported
        feedback.time_ns = self.clock.now_ns()
        feedback.position, feedback.velocity = source.position, source.velocity
        feedback.torque, feedback.current = source.torque, source.current
        feedback.temperature, feedback.fault = source.temperature, source.fault
        return True

    def _close(self) -> None:
        link, self._link = self._link, None
        if link is not None:
            link.close()
