"""The CiA 402 power state machine as tables [cia402]."""

from enum import Enum

__all__ = [
    "CLEAR_FAULT",
    "DISABLE_VOLTAGE",
    "ENABLE_STEPS",
    "ENERGISED",
    "STATE_OF_BITS",
    "DriveState",
    "decode_state",
]


class DriveState(Enum):
    """States of a drive. The value says how it is named to the user."""

    NOT_READY = "not ready to switch on"
    SWITCH_ON_DISABLED = "switch on disabled"
    READY_TO_SWITCH_ON = "ready to switch on"
    SWITCHED_ON = "switched on"
    OPERATION_ENABLED = "operation enabled"
    QUICK_STOP_ACTIVE = "quick stop active"
    FAULT_REACTION_ACTIVE = "fault reaction active"
    FAULT = "fault"


# States in which the motor may carry current: a quick stop and the reaction to a fault brake with it.
ENERGISED = frozenset({DriveState.OPERATION_ENABLED, DriveState.QUICK_STOP_ACTIVE, DriveState.FAULT_REACTION_ACTIVE})

# Statusword: mask, pattern, state.
STATUSWORDS = (
    (0x4F, 0x00, DriveState.NOT_READY),
    (0x4F, 0x40, DriveState.SWITCH_ON_DISABLED),
    (0x6F, 0x21, DriveState.READY_TO_SWITCH_ON),
    (0x6F, 0x23, DriveState.SWITCHED_ON),
    (0x6F, 0x27, DriveState.OPERATION_ENABLED),
    (0x6F, 0x07, DriveState.QUICK_STOP_ACTIVE),
    (0x4F, 0x0F, DriveState.FAULT_REACTION_ACTIVE),
    (0x4F, 0x08, DriveState.FAULT),
)

DISABLE_VOLTAGE = 0x00
SHUTDOWN = 0x06
SWITCH_ON = 0x07
ENABLE_OPERATION = 0x0F
CLEAR_FAULT = 0x80  # takes effect on its rising edge

# Controlword that leads one step closer to operation enabled. Out of a fault none does: that is the user's decision.
ENABLE_STEPS = {
    DriveState.NOT_READY: DISABLE_VOLTAGE,
    DriveState.SWITCH_ON_DISABLED: SHUTDOWN,
    DriveState.READY_TO_SWITCH_ON: SWITCH_ON,
    DriveState.SWITCHED_ON: ENABLE_OPERATION,
    DriveState.OPERATION_ENABLED: ENABLE_OPERATION,
    DriveState.QUICK_STOP_ACTIVE: DISABLE_VOLTAGE,
}

STATE_OF_BITS = {
    bits: next((state for mask, pattern, state in STATUSWORDS if bits & mask == pattern), DriveState.NOT_READY)
    for bits in range(0x80)
}


def decode_state(statusword: int) -> DriveState:
    """The state that a statusword tells."""
    return STATE_OF_BITS[statusword & 0x7F]
