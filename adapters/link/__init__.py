"""Ways to a bus: CAN frames through python-can, bytes through pyserial; their errors become ours here."""

from .can_link import CanLink, PythonCanLink
from .frame import CanFrame
from .serial_link import SerialLink, open_serial_link

__all__ = [
    "CanFrame",
    "CanLink",
    "PythonCanLink",
    "SerialLink",
    "open_serial_link",
]
