"""What a drive is asked and told by SDO before it moves: its cyclic modes, the period, who watches whom."""

from collections.abc import Callable
from math import tau

from fricomp.errors import AdapterConfigurationError, AdapterTimeout
from fricomp.joint import CommandMode

from . import objects
from .configuration import CanOpenConfiguration
from .drive import MODE_NUMBERS, CanOpenDrive

__all__ = ["clear_targets", "find_modes", "restart_watchdog", "set_mode", "set_period", "set_watchdog"]

_CIA_402 = 402

# What adds to a command without being part of it: a drive keeps it from whoever moved it before, even after a fault.
TARGETS = (
    objects.POSITION_OFFSET,
    objects.VELOCITY_OFFSET,
    objects.TORQUE_OFFSET,
    objects.TARGET_TORQUE,
    objects.TARGET_VELOCITY,
)
QUICK_STOP, FIRST_THAT_HOLDS = 3, 5
"""Of object 6007 the answer by a quick stop; of 605A the first value with which one ends energised [cia402]."""
STANDSTILL = 0.01 * tau
"""How far a target position may lie from where a limp motor was just now [rad]: drives let it follow the encoder."""

# Waits until a condition holds.
Wait = Callable[[Callable[[], bool]], None]


def find_modes(drive: CanOpenDrive) -> set[CommandMode]:
    """The cyclic modes of a drive.

    Raises:
        AdapterConfigurationError: It is no CiA 402 drive.
    """
    kind = drive.service.read(objects.DEVICE_TYPE) & 0xFFFF
    if kind != _CIA_402:
        raise AdapterConfigurationError(f"node {drive.node_id} is no CiA 402 drive: its device type is {kind}")
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


def clear_targets(drive: CanOpenDrive, mode: CommandMode) -> None:
    """Set all targets and offsets to zero, as far as the drive has them; in position mode, the target to where it is.

    Raises:
        AdapterConfigurationError: The drive keeps something else, which would add to every command.
    """
    service = drive.service
    for entry in TARGETS:
        service.write_if_present(entry, 0)
    if mode != "position":
        return
    present = service.read(objects.POSITION)
    service.write(objects.TARGET_POSITION, present)
    kept = service.read(objects.TARGET_POSITION)
    if abs(kept - present) * drive.scaling.position > STANDSTILL:
        raise AdapterConfigurationError(
            f"node {drive.node_id} is at {present} and keeps {kept} as its target position (607A): "
            f"it may be outside its own position limits (607D)"
        )


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
    service = drive.service
    if configuration.abort_option == QUICK_STOP:
        _refuse_holding(drive)
    service.write_confirmed(objects.PRODUCER_HEARTBEAT, round(configuration.heartbeat * 1e3))
    return (
        restart_watchdog(drive, configuration)
        and service.try_write(objects.ABORT_CONNECTION_OPTION, configuration.abort_option)
        and service.read(objects.ABORT_CONNECTION_OPTION) == configuration.abort_option
    )


def _refuse_holding(drive: CanOpenDrive) -> None:
    """A quick stop must end limp where it is to be the answer to our silence.

    Raises:
        AdapterConfigurationError: The drive would stay energised.
    """
    option = drive.service.read_if_present(objects.QUICK_STOP_OPTION)
    if option is not None and option >= FIRST_THAT_HOLDS:
        raise AdapterConfigurationError(
            f"node {drive.node_id} stays energised after a quick stop (605A is {option}), which abort_option = 3 asks "
            f"for when we fall silent: set 605A to 1 or 2, or abort_option to 1"
        )


def restart_watchdog(drive: CanOpenDrive, configuration: CanOpenConfiguration) -> bool:
    """Let the drive wait for the first heartbeat again before it misses one; whether it kept what was written.

    A consumer begins to watch with the first heartbeat that it hears after 1016 was set [cia301]. Through zero, because
    writing what stands there already need not restart it.
    """
    watched = configuration.master_id << 16 | round(configuration.watchdog * 1e3)
    service = drive.service
    return (
        service.try_write(objects.CONSUMER_HEARTBEAT, 0)
        and service.try_write(objects.CONSUMER_HEARTBEAT, watched)
        and service.read(objects.CONSUMER_HEARTBEAT) == watched
    )
