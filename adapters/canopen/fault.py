"""What the error codes of a CiA 402 drive mean, in words."""

# Beyond the 16 bits of a drive's own error codes.
FAULT_NOT_ENABLED = 0x10001
FAULT_MODE = 0x10002
FAULT_RESTARTED = 0x10003

_CODES = {
    FAULT_NOT_ENABLED: "it has left operation enabled, and tells no error",
    FAULT_MODE: "it has left its mode (6061)",
    FAULT_RESTARTED: "it has started again, or left the state operational",
    0x8110: "CAN overrun",
    0x8120: "CAN error passive",
    0x8130: "it missed our heartbeat: its watchdog",
    0x8140: "recovered from bus off",
    0x8611: "following error",
}
_CLASSES = (
    (0x1000, 0x1000, "generic error"),
    (0x2000, 0x2FFF, "current"),
    (0x3000, 0x3FFF, "voltage"),
    (0x4000, 0x4FFF, "temperature"),
    (0x5000, 0x5FFF, "device hardware"),
    (0x6000, 0x6FFF, "device software"),
    (0x7300, 0x73FF, "sensor"),
    (0x7000, 0x7FFF, "additional modules"),
    (0x8100, 0x81FF, "communication"),
    (0x8200, 0x82FF, "protocol error"),
    (0x8300, 0x83FF, "torque control"),
    (0x8400, 0x84FF, "velocity control"),
    (0x8500, 0x86FF, "position control"),
    (0x9000, 0x90FF, "external error"),
    (0xF000, 0xF0FF, "additional functions"),
    (0xFF00, 0xFFFF, "of this vendor"),
)
"""First and last code of what the profiles put together; the first that holds counts [cia301], [cia402]."""


def describe_fault(code: int) -> str:
    """The words of a code, or of the class that the profiles put it in; empty where it has none."""
    return _CODES.get(code) or next((word for first, last, word in _CLASSES if first <= code <= last), "")
