"""Endpoints of firmware 0.6: parameters by the numbers that the vendor publishes for each firmware version."""

import struct
from pathlib import Path
from typing import NamedTuple

import msgspec

from fricomp.errors import AdapterConfigurationError
from fricomp.untrusted import parse_json, read_whole

__all__ = [
    "CONTROL_MODE",
    "ENABLE_WATCHDOG",
    "HIGHEST_TORQUE",
    "INPUT_MODE",
    "LOWEST_TORQUE",
    "WATCHDOG_TIMEOUT",
    "Endpoint",
    "read_endpoints",
]

ENABLE_WATCHDOG = "axis0.config.enable_watchdog"
WATCHDOG_TIMEOUT = "axis0.config.watchdog_timeout"
CONTROL_MODE = "axis0.controller.config.control_mode"
INPUT_MODE = "axis0.controller.config.input_mode"
HIGHEST_TORQUE = "axis0.config.torque_soft_max"
LOWEST_TORQUE = "axis0.config.torque_soft_min"

FORMATS = {"bool": "<?", "float": "<f", "uint8": "<B", "uint16": "<H", "uint32": "<I", "int32": "<i"}
READ, WRITE = 0, 1

_NOT_ONE = "is not a flat_endpoints.json as the vendor publishes it for each firmware"


class Endpoint(NamedTuple):
    """One parameter.

    Attributes:
        number: Its number in this firmware.
        format: Its type, as in `struct`.
    """

    number: int
    format: str

    def read_request(self) -> bytes:
        """Ask for the value."""
        return struct.pack("<BHBI", READ, self.number, 0, 0)

    def write_request(self, value: float) -> bytes:
        """Set the value."""
        number = float(value) if self.format == "<f" else int(value)
        return struct.pack("<BHB", WRITE, self.number, 0) + struct.pack(self.format, number).ljust(4, b"\0")

    def decode(self, answer: bytes) -> float | None:
        """The value in an answer; None if it is about another endpoint or cut short."""
        size = struct.calcsize(self.format)
        if len(answer) < 4 + size or int.from_bytes(answer[1:3], "little") != self.number:
            return None
        return float(struct.unpack_from(self.format, answer, 4)[0])


def read_endpoints(path: str | Path) -> tuple[str, dict[str, Endpoint]]:
    """Firmware version and endpoints of a `flat_endpoints.json`.

    Raises:
        AdapterConfigurationError: The file cannot be read, or is something else.
    """
    try:
        text = read_whole(path)
    except OSError as error:
        raise AdapterConfigurationError(
            f"cannot read the endpoints {path}: {error.strerror or error}; download the flat_endpoints.json of exactly "
            "the drive's firmware from the vendor"
        ) from error
    try:
        content = parse_json(text)
        found = {
            name: Endpoint(int(entry["id"]), FORMATS[entry["type"]])
            for name, entry in content["endpoints"].items()
            if entry.get("type") in FORMATS
        }
        return str(content["fw_version"]), found
    except (msgspec.DecodeError, ValueError, OverflowError, KeyError, TypeError, AttributeError) as error:
        raise AdapterConfigurationError(f"{path} {_NOT_ONE}") from error
