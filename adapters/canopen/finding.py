"""Which CANopen nodes answer: device type and statusword are read by SDO."""

from collections.abc import Sequence

from ..asking import AskedBus, FoundDrive
from ..link import CanFrame
from .objects import DEVICE_TYPE, STATUSWORD, CanOpenObject
from .state_machine import ENERGISED, decode_state

__all__ = ["find_canopen"]

NODES = range(1, 128)
ANSWER_TIME = 0.2  # of the slowest node [s]
CLIENT, SERVER, HEARTBEAT = 0x600, 0x580, 0x700
UPLOAD, UPLOADED, ABORTED = 0x40, 0x40, 0x80
PROFILE_OF_DRIVES = 402  # lower word of the device type [cia402]
NMT_STATES = {0: "initialising", 4: "stopped", 5: "operational", 127: "pre-operational"}


def find_canopen(bus: AskedBus, heard: Sequence[CanFrame]) -> list[FoundDrive]:
    """Nodes that answer by SDO, and those whose heartbeat was heard.

    Args:
        bus: To ask on.
        heard: What came before anything was asked.
    """
    types = _read(bus, DEVICE_TYPE, NODES)
    drives = [node for node, value in types.items() if value is not None and value & 0xFFFF == PROFILE_OF_DRIVES]
    words = _read(bus, STATUSWORD, drives)
    beating = {frame.identifier - HEARTBEAT: frame.data[0] & 0x7F for frame in heard if _is_heartbeat(frame)}
    found = []
    for node in sorted(types.keys() | beating.keys()):
        word = words.get(node)
        state = None if word is None else decode_state(word)
        energised = None if state is None else state in ENERGISED
        what = _describe(types.get(node), beating.get(node)) + (f", {state.value}" if state is not None else "")
        found.append(FoundDrive("canopen", node, what, energised))
    return found


def _describe(device_type: int | None, nmt_state: int | None) -> str:
    if device_type is None:
        state = NMT_STATES.get(nmt_state if nmt_state is not None else -1, "in an unknown state")
        return f"CANopen node that answers nothing ({state})"
    profile = device_type & 0xFFFF
    return "CiA 402 drive" if profile == PROFILE_OF_DRIVES else f"CANopen node of profile {profile}, no CiA 402 drive"


def _read(bus: AskedBus, entry: CanOpenObject, nodes: Sequence[int]) -> dict[int, int | None]:
    """Values of an object by node; None for a node that refuses. Those that do not answer are left out."""
    place = entry.index.to_bytes(2, "little") + bytes((entry.subindex,))
    values: dict[int, int | None] = {}
    if not nodes:
        return values
    for frame in bus.ask([CanFrame(CLIENT + n, bytes((UPLOAD,)) + place + bytes(4)) for n in nodes], ANSWER_TIME):
        node = frame.identifier - SERVER
        if frame.extended or node not in nodes or len(frame.data) != 8 or frame.data[1:4] != place:
            continue
        if frame.data[0] == ABORTED:
            values[node] = None
        elif frame.data[0] & 0xE0 == UPLOADED:
            values[node] = entry.unpack(frame.data[4:])
    return values


def _is_heartbeat(frame: CanFrame) -> bool:
    return not frame.extended and frame.identifier - HEARTBEAT in NODES and len(frame.data) == 1
