"""What the errors of an ODrive mean, in words."""

from ..driver import name_bits

# Beyond the 32 bits of an axis.
FAULT_NOT_ENABLED = 0x1_0000_0001
FAULT_OF_PART = 0x1_0000_0002  # firmware 0.5: motor, encoder or controller report an error of their own

_OWN = {
    FAULT_NOT_ENABLED: "it has left closed loop control, and tells no error",
    FAULT_OF_PART: "its motor, encoder or controller reports an error of its own",
}
_ERRORS_06 = {
    0x1: "still initialising",
    0x2: "system error",
    0x4: "timing error",
    0x8: "no estimate of position or velocity",
    0x10: "bad configuration",
    0x20: "gate driver fault",
    0x40: "an input is missing",
    0x100: "supply voltage too high",
    0x200: "supply voltage too low",
    0x400: "supply current too high",
    0x800: "too much current returned to the supply",
    0x1000: "current limit exceeded",
    0x2000: "motor overheated",
    0x4000: "inverter overheated",
    0x8000: "velocity limit exceeded",
    0x1_0000: "position limit exceeded",
    0x100_0000: "its watchdog has fired, because it heard nothing",
    0x200_0000: "emergency stop requested",
    0x400_0000: "spin-out detected",
    0x800_0000: "brake resistor disarmed",
    0x1000_0000: "thermistor disconnected",
    0x4000_0000: "calibration error",
}
"""Bits of the active errors of firmware 0.6 [odrive2024]."""
_ERRORS_05 = {
    0x1: "invalid state",
    0x40: "motor failed",
    0x80: "sensorless estimator failed",
    0x100: "encoder failed",
    0x200: "controller failed",
    0x800: "its watchdog has fired, because it heard nothing",
    0x1000: "lower end stop pressed",
    0x2000: "upper end stop pressed",
    0x4000: "emergency stop requested",
    0x2_0000: "homing without an end stop",
    0x4_0000: "overheated",
    0x8_0000: "position not known",
}
"""Bits of the axis error of firmware 0.5 [odrive2024]."""


def describe_fault(code: int, minor: int) -> str:
    """The words of an error of firmware 0.`minor`; empty where nobody says what it means."""
    return _OWN.get(code) or name_bits(code, _ERRORS_05 if minor == 5 else _ERRORS_06)
