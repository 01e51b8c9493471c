"""The CiA 402 state machine as tables [cia402]."""

from enum import Enum

__all__ = ["DriveCommand", "DriveState", "command_of", "next_state", "status_word"]


class DriveState(Enum):
    """States, with the lower bits of the statusword that tell them."""

    SWITCH_ON_DISABLED = 0x0040
    READY_TO_SWITCH_ON = 0x0021
    SWITCHED_ON = 0x0023
    OPERATION_ENABLED = 0x0027
    QUICK_STOP_ACTIVE = 0x0007
    FAULT = 0x0008


class DriveCommand(Enum):
    """Commands that a controlword can carry, as (mask, pattern)."""

    SHUTDOWN = (0x87, 0x06)
    ENABLE_OPERATION = (0x8F, 0x0F)
    SWITCH_ON = (0x8F, 0x07)
    DISABLE_VOLTAGE = (0x82, 0x00)
    QUICK_STOP = (0x86, 0x02)


FAULT_RESET = 0x80
VOLTAGE_ENABLED, REMOTE, FOLLOWS_COMMAND = 0x0010, 0x0200, 0x1000

_S, _C = DriveState, DriveCommand
TRANSITIONS: dict[tuple[DriveState, DriveCommand], DriveState] = {
    (_S.SWITCH_ON_DISABLED, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,
    (_S.READY_TO_SWITCH_ON, _C.SWITCH_ON): _S.SWITCHED_ON,
    (_S.READY_TO_SWITCH_ON, _C.ENABLE_OPERATION): _S.OPERATION_ENABLED,
    (_S.READY_TO_SWITCH_ON, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,
    (_S.READY_TO_SWITCH_ON, _C.QUICK_STOP): _S.SWITCH_ON_DISABLED,
    (_S.SWITCHED_ON, _C.ENABLE_OPERATION): _S.OPERATION_ENABLED,
    (_S.SWITCHED_ON, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,
    (_S.SWITCHED_ON, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,
    (_S.SWITCHED_ON, _C.QUICK_STOP): _S.SWITCH_ON_DISABLED,
    (_S.OPERATION_ENABLED, _C.SWITCH_ON): _S.SWITCHED_ON,
    (_S.OPERATION_ENABLED, _C.SHUTDOWN): _S.READY_TO_SWITCH_ON,
    (_S.OPERATION_ENABLED, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,
    (_S.OPERATION_ENABLED, _C.QUICK_STOP): _S.QUICK_STOP_ACTIVE,
    (_S.QUICK_STOP_ACTIVE, _C.DISABLE_VOLTAGE): _S.SWITCH_ON_DISABLED,
}


def command_of(controlword: int) -> DriveCommand | None:
    """The command in a controlword, fault reset aside."""
    for command in DriveCommand:
        mask, pattern = command.value
        if controlword & mask == pattern:
            return command
    return None


def next_state(state: DriveState, controlword: int, before: int) -> DriveState:
    """The state after a controlword; `before` is the last one, whose rising bit 7 resets a fault."""
    if state is DriveState.FAULT:
        is_rising = bool(controlword & FAULT_RESET and not before & FAULT_RESET)
        return DriveState.SWITCH_ON_DISABLED if is_rising else state
    command = command_of(controlword)
    return state if command is None else TRANSITIONS.get((state, command), state)


def status_word(state: DriveState, *, follows: bool) -> int:
    """The statusword; `follows` says that a cyclic mode follows its command."""
    word = state.value | VOLTAGE_ENABLED | REMOTE
    return word | FOLLOWS_COMMAND if follows and state is DriveState.OPERATION_ENABLED else word
