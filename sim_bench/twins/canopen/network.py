"""What a CANopen node holds of its network: process data as configured, and frames sent in simulated time."""

from collections.abc import Callable
from dataclasses import dataclass, field

import canopen


@dataclass
class ProcessData:
    """One PDO as it is configured now."""

    identifier: int
    transmission: int
    entries: list[tuple[int, int, int]] = field(default_factory=list)
    event_period_ns: int = 0
    due_ns: int = 0
    syncs: int = 0
    pending: bytes | None = None

    @property
    def size(self) -> int:
        """Length of the frame [byte]."""
        return sum(bits for _, _, bits in self.entries) // 8


class PeriodicFrame(canopen.network.PeriodicMessageTask):
    """What the canopen package takes for its periodic heartbeat; sent in simulated time."""

    def __init__(self, identifier: int, data: bytes, period: float) -> None:
        self.identifier, self.data = identifier, bytes(data)
        self.period_ns, self.due_ns, self.stopped = round(period * 1e9), 0, False

    def update(self, data: bytes) -> None:
        """Send this from now on."""
        self.data = bytes(data)

    def stop(self) -> None:
        """Send no more."""
        self.stopped = True


class SimulatedNetwork(canopen.Network):
    """A network without a bus of its own."""

    def __init__(self, send: Callable[[int, bytes], None]) -> None:
        super().__init__()
        self._send = send
        self.periodic: list[PeriodicFrame] = []

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        """Send at once."""
        self._send(can_id, bytes(data))

    def send_periodic(self, can_id: int, data: bytes, period: float, remote: bool = False) -> PeriodicFrame:
        """Send whenever it is due; the node's `tick` sees to it."""
        frame = PeriodicFrame(can_id, data, period)
        self.periodic.append(frame)
        return frame
