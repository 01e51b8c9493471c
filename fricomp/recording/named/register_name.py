"""Registers of a Dynamixel X, as its programs call the columns: what one of them is worth [robotis2024]."""

import re
from typing import NamedTuple

_CALLED = re.compile(r"(?:^|[./ _])present[_ ]?(position|velocity|current)(?:[_ .\[]?\d+\]?)?$", re.IGNORECASE)


class Register(NamedTuple):
    """What one of a register is.

    Attributes:
        worth: In SI.
        said: The same in words.
    """

    worth: float
    said: str


_WORTH = {
    "position": Register(0.00153398, "4096 a turn of a Dynamixel X"),
    "velocity": Register(0.0239808, "0.229 rpm of a Dynamixel X"),
    "current": Register(0.00269, "2.69 mA of most Dynamixel X, 1 mA of XL330 and XC330: see its manual"),
}


def find_register(name: str) -> Register | None:
    """The register that a column is called as, `Present_Position`, `servo.present_current_2`; None of any other.

    Args:
        name: Of the column.
    """
    found = _CALLED.search(name)
    return _WORTH[found.group(1).lower()] if found else None
