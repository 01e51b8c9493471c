"""Twins on a serial line: bytes in, bytes out."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

from ..stand_in import StandIn
from .port import BytePort
from .twin import DriveTwin


class SerialTwin(DriveTwin):
    """Drives behind a byte stream.

    Args:
        port: The device's end of the line.
        stand_in: The joints.
        drives: One for each joint.
    """

    def __init__(self, port: BytePort, stand_in: StandIn, drives: Sequence[Any]) -> None:
        super().__init__(stand_in, drives)
        self.port = port

    def close(self) -> None:
        """Close the line."""
        with self._guard:
            self.port.close()

    def _pump(self) -> int:
        data = self.port.read()
        if data and not self.unplugged:
            self._feed(data)
        return len(data)

    def _send(self, data: bytes) -> None:
        if not self.unplugged:
            self.port.write(data)

    @abstractmethod
    def _feed(self, data: bytes) -> None:
        """Take bytes as they come, in any pieces."""
