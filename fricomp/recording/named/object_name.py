"""Objects of a drive by CiA 402, as columns are called by their addresses alone [cia402]."""

import re
from typing import NamedTuple

_OBJECTS = {
    **dict.fromkeys(("6064", "6063"), "position"),
    **dict.fromkeys(("606C", "6069"), "velocity"),
    "6077": "torque",
    "6078": "current",
    **dict.fromkeys(("6062", "607A"), "position_reference"),
    **dict.fromkeys(("606B", "60FF"), "velocity_reference"),
    **dict.fromkeys(("6071", "6074"), "torque_command"),
}
_ADDRESS = re.compile(
    rf"(?<![0-9A-Za-z])(?:0x)?({'|'.join(_OBJECTS)})(?:h|[:._ -]?(?:sub ?)?0?0)?(?![0-9A-Za-z])", re.IGNORECASE
)
"""An address, with the index 0 below it: `0x6064`, `6064h`, `6064:00`."""


class ObjectName(NamedTuple):
    """A column that is called as an object.

    Attributes:
        channel: Channel of a recording.
        left: The rest of the name, the joint's own.
    """

    channel: str
    left: str


def find_object(name: str) -> ObjectName | None:
    """The object that a column is called as, `axis1.0x6064`; None where it is none that is read.

    Args:
        name: Of the column.
    """
    found = _ADDRESS.search(name)
    if found is None:
        return None
    left = re.sub(r"[^0-9A-Za-z]+", "_", f"{name[: found.start()]} {name[found.end() :]}").strip("_")
    return ObjectName(_OBJECTS[found.group(1).upper()], left)
