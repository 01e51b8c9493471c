"""A bus in memory, in lock step with virtual time, and what all drives on it have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

from fricomp.adapters.link import CanFrame
from fricomp.testing import VirtualClock


class Peer(ABC):
    """A drive as the specification of its protocol has it, written without the adapter's codec."""

    def __init__(self) -> None:
        self.position = self.velocity = self.torque = 0.0
        self.on = self.failed = self.refuses_mode = False
        self.held = False  # by somebody who goes on commanding it
        self.now_ns = 0
        self.outbox: list[CanFrame] = []

    @abstractmethod
    def on_frame(self, frame: CanFrame) -> None:
        """Take a frame; answers go to the outbox."""

    @abstractmethod
    def on_time(self, now_ns: int) -> None:
        """Follow the time."""


class PeerBus:
    """The adapter's end of the bus."""

    def __init__(self, peers: Sequence[Peer], clock: VirtualClock) -> None:
        self.peers = peers
        clock.follow(self._on_time)
        self._on_time(clock.now_ns())

    def _on_time(self, now_ns: int) -> None:
        for peer in self.peers:
            peer.now_ns = now_ns
            peer.on_time(now_ns)

    def send(self, frames: Sequence[CanFrame]) -> None:
        for frame in frames:
            for peer in self.peers:
                peer.on_frame(frame)

    def receive(self) -> list[CanFrame]:
        frames = [frame for peer in self.peers for frame in peer.outbox]
        for peer in self.peers:
            peer.outbox.clear()
        return frames

    def discard_output(self) -> None:
        """Nothing waits here."""

    def close(self) -> None:
        """Nothing is held here."""
