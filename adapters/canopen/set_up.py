"""What a drive is asked and told by SDO before it moves: its cyclic modes, the period, who watches whom."""

from __future__ import annotations

from collections.abc import Callable

from fricomp.errors import AdapterConfigurationError, AdapterConnectionError, AdapterTimeout
from fricomp.joint import CommandMode

from . import objects
from .configuration import CanOpenConfiguration
from .drive import MODE_NUMBERS, CanOpenDrive
from .state_machine import DriveState

__all__ = ["find_modes", "set_mode", "set_period", "set_watchdog"]

_CIA_402 = 402

# Waits until a condition holds.
Wait = Callable[[Callable[[], bool]], None]


def find_modes(drive: CanOpenDrive) -> set[CommandMode]:
    """The cyclic modes of a drive.

    Raises:
        AdapterConfigurationError: It is no CiA 402 drive.
        AdapterConnectionError: It is energised by somebody else.
    """
    kind = drive.service.read(objects.DEVICE_TYPE) & 0xFFFF
    if kind != _CIA_402:
        raise AdapterConfigurationError(f"node {drive.node_id} is no CiA 402 drive: its device type is {kind}")
    drive.take_statusword(drive.service.read(objects.STATUSWORD))
    if drive.state is DriveState.OPERATION_ENABLED:
        raise AdapterConnectionError(f"node {drive.node_id} is energised by somebody else: disable it first")
    supported = drive.service.read(objects.SUPPORTED_MODES)
    return {mode for mode, number in MODE_NUMBERS.items() if supported >> (number - 1) & 1}


def set_mode(drive: CanOpenDrive, mode: CommandMode, wait: Wait) -> None:
    """Choose a cyclic mode.

    Raises:
        AdapterConfigurationError: The drive still shows another one when `wait` gives up.
    """
    number = MODE_NUMBERS[mode]
    drive.service.write(objects.MODE, number)
    found: list[int] = []

    def taken() -> bool:
        found.append(drive.service.read(objects.MODE_DISPLAY))
        return found[-1] == number

    try:
        wait(taken)
    except AdapterTimeout as error:
        raise AdapterConfigurationError(
            f"node {drive.node_id} does not take mode {number} ({mode}): it shows {found[-1]} in object 6061"
        ) from error


def set_period(drive: CanOpenDrive, period: float) -> None:
    """Tell the drive how often references come [s], where it wants to know."""
    for exponent in (-3, -4, -5):
        count = round(period * 10.0**-exponent)
        if abs(count * 10.0**exponent - period) < 1e-9 and 1 <= count <= 255:
            drive.service.try_write(objects.INTERPOLATION_PERIOD, count)
            drive.service.try_write(objects.INTERPOLATION_EXPONENT, exponent)
            return


def set_watchdog(drive: CanOpenDrive, configuration: CanOpenConfiguration) -> bool:
    """Let the drive watch our heartbeat, and us watch its; whether it kept what was written."""
    watched = configuration.master_id << 16 | round(configuration.watchdog * 1e3)
    service = drive.service
    service.write_confirmed(objects.PRODUCER_HEARTBEAT, round(configuration.heartbeat * 1e3))
    drive.heard_ns = None
    return (
        service.try_write(objects.CONSUMER_HEARTBEAT, watched)
        and service.try_write(objects.ABORT_CONNECTION_OPTION, configuration.abort_option)
        and service.read(objects.CONSUMER_HEARTBEAT) == watched
        and service.read(objects.ABORT_CONNECTION_OPTION) == configuration.abort_option
    )
