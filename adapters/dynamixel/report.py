"""What every cycle asks of a servo: state and condition in one block, put together by its indirect addresses."""

import struct
from collections.abc import Callable, Sequence
from math import nan

from ..driver import name_bits
from .control_table import BUS_WATCHDOG, HARDWARE_ERROR, STATE, TORQUE_ENABLE, Item
from .packet import bulk_read_packet, sync_read_packet

__all__ = [
    "FAULT_WATCHDOG",
    "INDIRECT_ADDRESSES",
    "MAPPING",
    "REPORT_SIZE",
    "STATUS_BYTES",
    "UNBOUNDED",
    "Report",
    "compute_fault",
    "describe_fault",
    "read_plain",
    "read_report",
    "report_request",
]

ALERT, WATCHDOG_FIRED = 0x80, 0xFF
# Faults that are found here, beside the servos' own bits.
FAULT_NOT_ENABLED, FAULT_WATCHDOG, FAULT_RESTARTED, FAULT_TORQUE = 0x100, 0x200, 0x400, 0x800
_OWN_WORDS = {
    FAULT_NOT_ENABLED: "its torque is off, though it was switched on",
    FAULT_WATCHDOG: "its bus watchdog has fired, because it heard nothing",
    FAULT_RESTARTED: "it has started again",
    FAULT_TORQUE: "it draws more current than the torque limit allows",
    ALERT: "it tells of a hardware error, and not of which",
}
_HARDWARE_WORDS = {
    0x01: "input voltage out of its range",
    0x04: "overheated",
    0x08: "encoder fault",
    0x10: "electrical shock, or too little power",
    0x20: "overloaded",
}
"""Bits of the hardware error status [robotis2024]."""

UNBOUNDED = 0x10000
"""More current than any servo reports."""

# Of a status packet beside its data.
STATUS_BYTES = 11

_TEMPERATURE = Item(146, 1)
_LAYOUT, _PLAIN_LAYOUT = struct.Struct("<hiiBBBB"), struct.Struct("<hii")
_SHOWN = [
    address
    for item in (STATE, _TEMPERATURE, TORQUE_ENABLE, HARDWARE_ERROR, BUS_WATCHDOG)
    for address in range(item.address, item.address + item.size)
]

REPORT_SIZE = _LAYOUT.size
"""Of one servo [byte]: 14 of the 20 indirect data that the smallest models have."""
MAPPING = struct.pack(f"<{len(_SHOWN)}H", *_SHOWN)
"""What stands in the indirect addresses, so that the indirect data show a report."""
INDIRECT_ADDRESSES = Item(168, len(MAPPING))


Report = tuple[int, int, int, float, int, int, int]
"""One servo's state and condition, in its own counts: present current, velocity, position, temperature [°C], torque
enable, hardware error, and what is left of the bus watchdog's setting: 255 once it has fired, 0 in a servo that has
started again, whose indirect addresses are as delivered, too, so that nothing else of this report is true."""

read_report: Callable[[bytes], Report] = _LAYOUT.unpack
"""The report in `REPORT_SIZE` bytes; without a call of ours around it, for every state."""


def read_plain(data: bytes) -> Report:
    """The same of current, velocity and position alone, from a servo that has not been prepared for more."""
    current, velocity, position = _PLAIN_LAYOUT.unpack(data)
    return current, velocity, position, nan, 0, 0, WATCHDOG_FIRED


def compute_fault(report: Report, error: int, guard: int | None, most: int) -> int:
    """What is wrong with a servo, its own error first; 0 if nothing.

    Args:
        report: Of the servo.
        error: Of the packet that brought it.
        guard: Setting of the bus watchdog; None while the servo need not be energised.
        most: Largest current [counts].
    """
    current, _, _, _, energised, hardware_error, watchdog = report
    if error & ALERT:
        return hardware_error or ALERT
    if guard is None:
        return 0
    if watchdog != guard:
        return FAULT_WATCHDOG if watchdog else FAULT_RESTARTED
    if not energised:
        return FAULT_NOT_ENABLED
    return FAULT_TORQUE if abs(current) > most else 0


def describe_fault(code: int) -> str:
    """What a code of `compute_fault` means, in words; empty where the manual does not say."""
    return _OWN_WORDS.get(code) or name_bits(code, _HARDWARE_WORDS)


def report_request(servos: bytes, data_addresses: Sequence[int]) -> bytes:
    """One packet that asks all servos for their report, also where their indirect data begin at different addresses."""
    if len(set(data_addresses)) == 1:
        return sync_read_packet(data_addresses[0], REPORT_SIZE, servos)
    return bulk_read_packet(REPORT_SIZE, dict(zip(servos, data_addresses, strict=True)))
