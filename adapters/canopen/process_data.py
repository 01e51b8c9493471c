"""Process data: what is mapped into which PDO, how it is packed, and how a node is told so."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fricomp.joint import CommandMode

from . import objects
from .objects import CanOpenObject
from .service import ServiceChannel

__all__ = ["COMMAND_OBJECTS", "STATE_OBJECTS", "STATE_PACKERS", "Direction", "command_packer", "map_process_data"]

# Torque comes as the target itself, or as an offset (60B2) to what the drive's own loop demands.
COMMAND_OBJECTS: Mapping[CommandMode, tuple[CanOpenObject, ...]] = {
    "torque": (objects.CONTROLWORD, objects.TARGET_TORQUE),
    "velocity": (objects.CONTROLWORD, objects.TARGET_VELOCITY, objects.TORQUE_OFFSET),
    "position": (objects.CONTROLWORD, objects.TARGET_POSITION, objects.TORQUE_OFFSET),
}

STATE_OBJECTS: tuple[tuple[CanOpenObject, ...], ...] = (
    (objects.STATUSWORD, objects.POSITION, objects.TORQUE),
    (objects.VELOCITY, objects.ERROR_CODE, objects.MODE_DISPLAY),
)

ON_EVERY_SYNC = 1
INVALID = 0x80000000
N_STANDARD_PDOS = 4


@dataclass(frozen=True)
class Direction:
    """Where a node keeps its PDOs of one direction.

    Attributes:
        communication: Index of the first communication record.
        mapping: Index of the first mapping record.
        identifier: Identifier of the first, without the node.
    """

    communication: int
    mapping: int
    identifier: int


RECEIVED = Direction(0x1400, 0x1600, 0x200)
TRANSMITTED = Direction(0x1800, 0x1A00, 0x180)


def packer(entries: Sequence[CanOpenObject]) -> struct.Struct:
    """How mapped objects follow each other in a frame."""
    return struct.Struct("<" + "".join(entry.format for entry in entries))


STATE_PACKERS = tuple(map(packer, STATE_OBJECTS))


def command_packer(mode: CommandMode) -> struct.Struct:
    """How the command of a mode is packed."""
    return packer(COMMAND_OBJECTS[mode])


def map_process_data(service: ServiceChannel, node_id: int, mode: CommandMode) -> None:
    """Tell a node, in pre-operational, what to take and to send on every SYNC; all of it is read back.

    Raises:
        AdapterError: The node refuses, or keeps something else.
    """
    _map(service, node_id, RECEIVED, [COMMAND_OBJECTS[mode]])
    _map(service, node_id, TRANSMITTED, STATE_OBJECTS)


def _map(service: ServiceChannel, node_id: int, direction: Direction, pdos: Sequence[Sequence[CanOpenObject]]) -> None:
    for number in range(N_STANDARD_PDOS):
        identifier = direction.identifier + 0x100 * number + node_id
        cob_id = CanOpenObject(direction.communication + number, 1, "I")
        if number >= len(pdos):
            service.try_write(cob_id, INVALID | identifier)  # a drive need not have all four
            continue
        service.write(cob_id, INVALID | identifier)
        count = CanOpenObject(direction.mapping + number, 0, "B")
        service.write(count, 0)
        for place, entry in enumerate(pdos[number], start=1):
            service.write_confirmed(CanOpenObject(direction.mapping + number, place, "I"), entry.mapping)
        service.write_confirmed(count, len(pdos[number]))
        service.write_confirmed(CanOpenObject(direction.communication + number, 2, "B"), ON_EVERY_SYNC)
        service.write(cob_id, identifier)
