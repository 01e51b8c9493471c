"""The limit that a drive itself holds to (6072): the only one that bounds what its own loop asks for."""

from collections.abc import Sequence

from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout
from fricomp.joint import CommandMode

from . import objects
from .drive import CanOpenDrive
from .state_machine import DriveState

__all__ = ["find_most_torque", "restore_torque_limits", "set_torque_limit"]

LIMP = (DriveState.NOT_READY, DriveState.SWITCH_ON_DISABLED, DriveState.READY_TO_SWITCH_ON, DriveState.FAULT)


def find_most_torque(drive: CanOpenDrive, torque: float) -> float:
    """The torque that a drive lets through [N·m at the motor], for a joint that is limited to `torque`.

    A limit less than a count beyond it is the drive's, too: a run that was killed has left it there, rounded down.

    Raises:
        AdapterConfigurationError: The limit is beyond the drive's.
    """
    scaling = drive.scaling
    if scaling.count_within(torque) > scaling.highest_torque_count:
        raise AdapterConfigurationError(
            f"the torque limit of {torque:g} N·m at the motor is beyond the drive's {scaling.highest_torque:g} (6072): "
            f"lower the limit, or raise 6072; a run that was killed leaves its own there until the drive restarts"
        )
    return max(torque, scaling.highest_torque)


def set_torque_limit(drive: CanOpenDrive, torque: float, mode: CommandMode) -> None:
    """Write a limit into the drive, rounded toward zero, and read it back.

    In velocity and position mode the drive's loop asks for whatever its gains make of an error, and nothing of that
    passes through the gate. In torque mode, where every command does, a drive without this object will do.

    Args:
        drive: At rest.
        torque: At the motor [N·m].
        mode: Of the commands to come.

    Raises:
        AdapterTimeout: The drive does not answer.
        AdapterConfigurationError: The drive does not take the limit in velocity or position mode, or keeps a lower one.
    """
    count = drive.scaling.count_within(torque)
    try:
        _write(drive, count)
    except AdapterTimeout:
        raise
    except AdapterError as error:
        kept = drive.service.read_if_present(objects.MAX_TORQUE)
        if mode == "torque" and not (kept and kept < count):
            return
        raise AdapterConfigurationError(
            f"{mode} mode is refused: the drive does not take the torque limit of {torque:g} N·m at the motor as its "
            f"own ({error}), and nothing else would bound its loop"
        ) from error


def _write(drive: CanOpenDrive, count: int) -> None:
    if count < 1:  # zero may mean no torque or no limit, as the vendor likes
        raise AdapterConfigurationError(f"it is below the {drive.scaling.torque:g} N·m that object 6072 counts in")
    found = drive.service.read(objects.MAX_TORQUE)
    if drive.max_torque_found is None:
        drive.max_torque_found = found
    if 0 < drive.max_torque_found < count:  # whoever set up the drive had a reason
        raise AdapterConfigurationError(f"object 6072 permitted no more than {drive.max_torque_found} counts of it")
    drive.service.write_confirmed(objects.MAX_TORQUE, count)


def restore_torque_limits(drives: Sequence[CanOpenDrive]) -> None:
    """Leave the limits behind that were found, where others were written; not in a drive that may be energised.

    Raises:
        AdapterError: A drive does not answer or refuses; those after it keep the lower limit.
    """
    for drive in drives:
        if drive.max_torque_found is not None:
            _restore(drive, drive.max_torque_found)


def _restore(drive: CanOpenDrive, found: int) -> None:
    drive.take_statusword(drive.service.read(objects.STATUSWORD))
    if drive.state in LIMP:
        drive.service.write(objects.MAX_TORQUE, found)
        drive.max_torque_found = None
