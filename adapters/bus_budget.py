"""How often a bus can carry what all its joints exchange: counted in bits, worst case."""

from collections.abc import Sequence
from dataclasses import dataclass


def can_frame_bits(n_bytes: int, extended: bool = False) -> int:
    """Longest time of a classical CAN frame on the bus, interframe space and worst-case stuff bits included [bit].

    Stuffing adds at most one bit in four to the 34 (standard) or 54 (extended) control bits and the data [davis2007].
    """
    control = 54 if extended else 34
    return control + 8 * n_bytes + 13 + (control + 8 * n_bytes - 1) // 4


def can_fd_frame_time(n_bytes: int) -> float:
    """Longest time of a CAN-FD frame with standard identifier at 1 Mbit/s, its data at 5 Mbit/s [s].

    As ISO 11898-1 counts: 30 bits at the slow rate with their stuffing and 8 + data + CRC bits at the fast one with
    theirs.
    """
    crc = 17 + 4 + 1 if n_bytes <= 16 else 21 + 5 + 1
    slow = 17 + 4 + 13
    fast = 8 + 8 * n_bytes
    return slow / 1e6 + (fast + fast // 4 + crc + crc // 4) / 5e6


def serial_time(n_bytes: int, baudrate: float) -> float:
    """Time of bytes on an asynchronous line with one start and one stop bit [s]."""
    return 10.0 * n_bytes / baudrate


@dataclass(frozen=True)
class BusBudget:
    """What one control cycle of all joints costs on the bus.

    Attributes:
        frame_times: Time of every frame of a cycle [s].
        background_load: Share of the bus that other frames take, such as heartbeats [1].
    """

    frame_times: Sequence[float]
    background_load: float = 0.0

    @property
    def cycle_time(self) -> float:
        """Time of a whole cycle on the bus [s]."""
        return sum(self.frame_times)

    @property
    def highest_rate(self) -> float:
        """Highest rate at which every frame of every cycle fits, worst case [Hz]."""
        return max(1.0 - self.background_load, 0.0) / self.cycle_time
