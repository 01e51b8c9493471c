"""Process data: what is mapped into which PDO, how it is packed, and how a node is told so."""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout
from fricomp.joint import CommandMode

from . import objects
from .objects import CanOpenObject
from .service import ServiceChannel

__all__ = [
    "COMMAND_OBJECTS",
    "STATE_OBJECTS",
    "STATE_PACKERS",
    "Direction",
    "Identifiers",
    "command_packer",
    "map_process_data",
]

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
N_STANDARD_PDOS, MOST_ENTRIES = 4, 8
# Of a COB-ID [cia301]: the PDO is off, its identifier is long, and the identifier itself; bit 30 is the node's.
INVALID, EXTENDED, IDENTIFIER, LONG_IDENTIFIER = 0x80000000, 0x20000000, 0x7FF, 0x1FFFFFFF


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


class Identifiers(NamedTuple):
    """Under which identifiers the process data of a node go.

    Attributes:
        command: Of the command.
        states: Of both states.
    """

    command: int
    states: tuple[int, ...]


def map_process_data(service: ServiceChannel, node_id: int, mode: CommandMode) -> Identifiers:
    """Tell a node, in pre-operational, what to take and to send on every SYNC; all of it is read back.

    What the node has already is left as it is: a mapping that is right, though it may be fixed, the identifiers of
    another layout, and all other bits of a COB-ID, which some nodes do not let go.

    Raises:
        AdapterError: The node refuses, or keeps something else.
    """
    (command,) = _map(service, node_id, RECEIVED, [COMMAND_OBJECTS[mode]])
    return Identifiers(command, tuple(_map(service, node_id, TRANSMITTED, STATE_OBJECTS)))


def _map(
    service: ServiceChannel, node_id: int, direction: Direction, pdos: Sequence[Sequence[CanOpenObject]]
) -> list[int]:
    """Find or make a place for each of the PDOs, and switch the others off; their identifiers."""
    wanted = [[entry.mapping for entry in entries] for entries in pdos]
    places = _find_places([_read_mapping(service, direction, number) for number in range(N_STANDARD_PDOS)], wanted)
    found: dict[int, int] = {}
    for number in range(N_STANDARD_PDOS):
        cob_id = CanOpenObject(direction.communication + number, 1, "I")
        kept = service.read_if_present(cob_id)
        if kept is None and number not in places:
            continue  # a drive need not have all four
        own = direction.identifier + 0x100 * number + node_id
        if kept is None or not kept & IDENTIFIER:
            kept = (kept or 0) | own
        if kept & EXTENDED:
            kept = kept & ~(EXTENDED | LONG_IDENTIFIER) | own
        if number not in places:
            service.try_write(cob_id, INVALID | kept)
            continue
        service.write(cob_id, INVALID | kept)
        _write_mapping(service, node_id, direction.mapping + number, wanted[places.index(number)])
        kind = CanOpenObject(direction.communication + number, 2, "B")
        if service.read(kind) != ON_EVERY_SYNC:
            service.write_confirmed(kind, ON_EVERY_SYNC)
        service.write(cob_id, kept & ~INVALID)
        found[number] = kept & IDENTIFIER
    return [found[number] for number in places]


def _read_mapping(service: ServiceChannel, direction: Direction, number: int) -> list[int]:
    """What stands in a PDO; nothing where there is none."""
    index = direction.mapping + number
    count = service.read_if_present(CanOpenObject(index, 0, "B")) or 0
    return [service.read(CanOpenObject(index, place, "I")) for place in range(1, min(count, MOST_ENTRIES) + 1)]


def _find_places(mapped: Sequence[list[int]], wanted: Sequence[list[int]]) -> list[int]:
    """For each PDO that is wanted the number of the one that has it already, else the lowest that is free."""
    kept = [mapped.index(entries) if entries in mapped else None for entries in wanted]
    free = [number for number in range(len(mapped)) if number not in kept]
    return [free.pop(0) if number is None else number for number in kept]


def _write_mapping(service: ServiceChannel, node_id: int, index: int, entries: Sequence[int]) -> None:
    """Map these entries, unless they are mapped already.

    Raises:
        AdapterConfigurationError: The node keeps others.
    """
    count = CanOpenObject(index, 0, "B")
    places = [CanOpenObject(index, place, "I") for place in range(1, len(entries) + 1)]
    if service.read(count) == len(entries) and [service.read(place) for place in places] == list(entries):
        return
    try:
        service.write(count, 0)
        for place, entry in zip(places, entries, strict=True):
            service.write_confirmed(place, entry)
        service.write_confirmed(count, len(entries))
    except AdapterTimeout:
        raise
    except AdapterError as error:
        needed = ", ".join(f"{entry:#010x}" for entry in entries)
        raise AdapterConfigurationError(
            f"node {node_id} does not take the mapping {needed} in {index:#06x} ({error}): where its mapping is fixed, "
            f"one of its first four PDOs must have exactly these entries"
        ) from error
