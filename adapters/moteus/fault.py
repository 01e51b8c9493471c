"""What the codes of a moteus mean, in words."""

from .codec import MODE_FAULT, MODE_STOPPED, MODE_TIMEOUT

FAULT_MODE = 0x1000
"""Beyond the controllers' own codes: a mode that ends a command, such as 11, its timeout."""

_MODES = {
    MODE_STOPPED: "it is stopped, though it was switched on: it has started again, or somebody else stopped it",
    MODE_FAULT: "it is in its fault mode, and does not say why",
    MODE_TIMEOUT: "its watchdog has fired, because it heard nothing",
}
"""Modes that end a command."""
_CODES = {
    32: "calibration fault",
    33: "motor driver fault",
    34: "supply voltage too high",
    35: "encoder fault",
    36: "motor not calibrated",
    37: "its control loop has overrun",
    38: "overheated",
    39: "it was started outside its position limits",
    40: "supply voltage too low",
    41: "its configuration was changed while it was energised",
    42: "no valid encoder for commutation",
    43: "no valid position",
    44: "motor driver could not be enabled",
    46: "timing violation",
}
"""Fault codes [mjbots2024]."""


def describe_fault(code: int) -> str:
    """The words of a code; empty where nobody says what it means."""
    if code < FAULT_MODE:
        return _CODES.get(code, "")
    return _MODES.get(code - FAULT_MODE, f"it is in mode {code - FAULT_MODE}, not in that of positions")
