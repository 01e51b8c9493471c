"""Which ODrives there are: their heartbeats are heard, and nothing is asked."""

from collections.abc import Sequence

from ..asking import FoundDrive
from ..link import CanFrame
from .codec import AxisState, Command

__all__ = ["find_odrive"]

NODES = range(63)
STATES = range(1, 15)  # of an axis [odrive2024]; 0 is undefined, and gone by the first heartbeat
FEWEST = 2
FASTEST = 0.01
"""Shortest period of a heartbeat [s]; what comes faster under its identifier is another protocol's command."""


def find_odrive(heard: Sequence[CanFrame], seconds: float) -> list[FoundDrive]:
    """Nodes that sent heartbeats.

    Args:
        heard: What came on the bus while nothing was asked.
        seconds: For so long [s].
    """
    beats: dict[int, list[bytes]] = {}
    for frame in heard:
        node, command = frame.identifier >> 5, frame.identifier & 0x1F
        if not frame.extended and node in NODES and command == Command.HEARTBEAT and len(frame.data) == 8:
            beats.setdefault(node, []).append(frame.data)
    found = []
    for node, data in sorted(beats.items()):
        if FEWEST <= len(data) <= seconds / FASTEST and all(beat[4] in STATES for beat in data):
            error, state = int.from_bytes(data[-1][:4], "little"), data[-1][4]
            what = f"ODrive axis in state {state}" + (f", error {error:#x}" if error else "")
            found.append(FoundDrive("odrive", node, what, state != AxisState.IDLE))
    return found
