"""Serial ports by their USB serial number, which stays when a replugged `ttyACM0` comes back as `ttyACM1`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fricomp.errors import AdapterConnectionError
from fricomp.extras import needing

BY_SERIAL_NUMBER = "usb:"
"""What a port begins with that is named by its serial number: `usb:FT6S4DSP`."""


class SerialPort(NamedTuple):
    """A serial port of this machine.

    Attributes:
        device: What opens it, such as `/dev/ttyACM0` or `COM3`.
        serial_number: Of its USB device; empty where it has none.
        description: As the operating system tells it.
        is_usb: Whether it is on USB.
    """

    device: str
    serial_number: str
    description: str
    is_usb: bool

    @property
    def name(self) -> str:
        """How a configuration best names it: by its serial number, if it has one."""
        return f"{BY_SERIAL_NUMBER}{self.serial_number}" if self.serial_number else self.device


def list_serial_ports() -> tuple[SerialPort, ...]:
    """All serial ports, sorted by device.

    Raises:
        MissingExtraError: pyserial is not installed.
    """
    with needing("pyserial", "serial"):
        from serial.tools.list_ports import comports
    ports = [SerialPort(p.device, p.serial_number or "", p.description or "", p.vid is not None) for p in comports()]
    return tuple(sorted(ports))


def find_device(port: str) -> str:
    """What opens a port: itself, unless it is named by its serial number.

    Raises:
        AdapterConnectionError: No port has this number, or several have.
        MissingExtraError: pyserial is not installed.
    """
    if not port.startswith(BY_SERIAL_NUMBER):
        return port
    number, ports = port[len(BY_SERIAL_NUMBER) :], list_serial_ports()
    found = [known.device for known in ports if known.serial_number == number]
    if len(found) == 1:
        return found[0]
    if found:
        raise AdapterConnectionError(f"{', '.join(found)} have serial number {number!r} all: name one by its device")
    known = ", ".join(p.name for p in ports if p.serial_number) or "none"
    raise AdapterConnectionError(f"no serial port has number {number!r}, is it plugged in? There are: {known}")


def find_holders(device: str) -> Sequence[str]:
    """Other processes that have a device open, where Linux tells it: number and name of each."""
    try:
        device_id = os.stat(device).st_rdev
        processes = [entry for entry in Path("/proc").iterdir() if entry.name.isdigit()]
    except OSError:
        return ()
    others = (process for process in processes if int(process.name) != os.getpid() and device_id)
    return tuple(f"process {p.name} ({_name_of(p)})" for p in others if _has_open(p, device_id))


def _has_open(process: Path, device_id: int) -> bool:
    try:
        return any(_device_of(descriptor) == device_id for descriptor in (process / "fd").iterdir())
    except OSError:  # another user's, or gone
        return False


def _device_of(descriptor: Path) -> int:
    try:
        return descriptor.stat().st_rdev
    except OSError:
        return 0


def _name_of(process: Path) -> str:
    try:
        return (process / "comm").read_text().strip()
    except OSError:
        return "gone"
