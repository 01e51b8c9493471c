"""Asking a bus or a line who is there: drives are read, and nothing is written to any of them."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fricomp.joint import Clock

from .link import CanFrame, CanLink, SerialLink

__all__ = ["AskedBus", "AskedLine", "FoundDrive"]

PAUSE_NS = 1_000_000
"""Between two questions on a CAN bus [ns]: other programs' frames find a place, and no receiver is flooded."""


class FoundDrive(NamedTuple):
    """A drive that has answered, or that was heard.

    Attributes:
        protocol: Name of its adapter.
        address: Its motor id, node, axis, controller or servo: the `id` of a joint.
        what: What it says about itself.
        energised: Whether it says that it is; None where it does not tell.
    """

    protocol: str
    address: int
    what: str
    energised: bool | None


class AskedBus:
    """A CAN bus on which drives are asked.

    Args:
        link: Open already.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(self, link: CanLink, clock: Clock) -> None:
        self._link, self._clock = link, clock

    def ask(self, questions: Sequence[CanFrame], seconds: float) -> list[CanFrame]:
        """Send questions one by one; everything that comes until so long [s] after the last.

        Raises:
            AdapterConnectionError: The bus is off or gone.
        """
        heard: list[CanFrame] = []
        for question in questions:
            self._link.send([question])
            self._clock.sleep_until(self._clock.now_ns() + PAUSE_NS)
            heard += self._link.receive()
        return heard + self.listen(seconds)

    def listen(self, seconds: float) -> list[CanFrame]:
        """Everything that comes within so long [s]; nothing is sent.

        Raises:
            AdapterConnectionError: The bus is off or gone.
        """
        heard: list[CanFrame] = []
        deadline = self._clock.now_ns() + round(seconds * 1e9)
        while self._clock.now_ns() < deadline:
            self._clock.sleep_until(self._clock.now_ns() + PAUSE_NS)
            heard += self._link.receive()
        return heard


class AskedLine:
    """A serial line on which drives are asked.

    Args:
        link: Open already.
        clock: Real time unless a simulation brings its own.
        baudrate: Of the line [baud].
    """

    def __init__(self, link: SerialLink, clock: Clock, baudrate: int) -> None:
        self._link, self._clock, self.baudrate = link, clock, baudrate

    def ask(self, question: bytes, seconds: float, is_whole: Callable[[bytes], bool] = lambda _: False) -> bytes:
        """Send a question; what comes within so long [s], or until it is whole.

        Raises:
            AdapterConnectionError: The port is gone.
        """
        self._link.receive()  # what came before is no answer
        self._link.send(question)
        answer = b""
        deadline = self._clock.now_ns() + round(seconds * 1e9)
        while self._clock.now_ns() < deadline and not is_whole(answer):
            self._clock.sleep_until(self._clock.now_ns() + PAUSE_NS)
            answer += self._link.receive()
        return answer
