"""Twins on a CAN bus: any number of devices with one joint each behind one bus connection."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Protocol

import can

from ..stand_in import StandIn
from .twin import DriveTwin

__all__ = ["CanDevice", "CanPort", "CanTwin", "SendFrame"]

SendFrame = Callable[[int, bytes, bool], None]
"""(identifier, data, whether the identifier has 29 bits)."""

# Frames answered in one go, so that a flood cannot keep the joints from moving.
LARGEST_BATCH = 1000


class CanPort(Protocol):
    """The part of `can.BusABC` that a twin needs."""

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame, or None."""

    def send(self, msg: can.Message) -> None:
        """Send a frame."""

    def shutdown(self) -> None:
        """Let go of the bus."""


class CanDevice(ABC):
    """One drive on the bus."""

    send: SendFrame

    @abstractmethod
    def receive(self, message: can.Message) -> None:
        """Take any frame on the bus; ignore what is for others or makes no sense."""

    @abstractmethod
    def tick(self, now_ns: int) -> None:
        """Watchdogs and periodic frames."""

    @abstractmethod
    def power_cycle(self) -> None:
        """Back to what is stored, de-energised."""


class CanTwin(DriveTwin):
    """Drives on a bus.

    Args:
        port: A python-can bus of its own, or another `CanPort`.
        stand_in: The joints.
        devices: One drive for each joint.
    """

    drives: tuple[CanDevice, ...]

    def __init__(self, port: CanPort, stand_in: StandIn, devices: Sequence[CanDevice]) -> None:
        super().__init__(stand_in, devices)
        self.port = port
        for device in self.drives:
            device.send = self._send

    def close(self) -> None:
        """Let go of the bus."""
        with self._guard:
            self.port.shutdown()

    def _pump(self) -> int:
        for count in range(LARGEST_BATCH):
            message = self.port.recv(0.0)
            if message is None:
                return count
            if self.unplugged or message.is_error_frame:
                continue
            for device in self.drives:
                device.receive(message)
        return LARGEST_BATCH

    def _send(self, identifier: int, data: bytes, extended: bool = False) -> None:
        if not self.unplugged:
            self.port.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=extended))
