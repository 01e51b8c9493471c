"""Resetting a latched fault by SDO alone: for nodes whose process data nobody has configured."""

from collections.abc import Callable

from fricomp.errors import AdapterTimeout, DriveFault

from . import objects
from .drive import CanOpenDrive
from .state_machine import CLEAR_FAULT, DISABLE_VOLTAGE, DriveState

__all__ = ["clear_by_service"]

FAULTS = (DriveState.FAULT, DriveState.FAULT_REACTION_ACTIVE)

# Waits until a condition holds.
Wait = Callable[[Callable[[], bool]], None]


def clear_by_service(drive: CanOpenDrive, wait: Wait) -> None:
    """Reset a fault; a drive that has none is left as it is.

    Raises:
        AdapterTimeout: The node does not answer.
        DriveFault: The fault stays.
    """
    service = drive.service

    def is_clear() -> bool:
        drive.take_statusword(service.read(objects.STATUSWORD))
        if drive.state is DriveState.FAULT:  # bit 7 takes effect as it rises, and may come before the cause is gone
            service.write(objects.CONTROLWORD, DISABLE_VOLTAGE)
            service.write(objects.CONTROLWORD, CLEAR_FAULT)
            service.write(objects.CONTROLWORD, DISABLE_VOLTAGE)
            drive.take_statusword(service.read(objects.STATUSWORD))
        return drive.state not in FAULTS

    try:
        wait(is_clear)
    except AdapterTimeout as error:
        drive.error_code = service.read_if_present(objects.ERROR_CODE) or 0
        if drive.state not in FAULTS:
            raise
        raise DriveFault(
            f"the fault stays (node {drive.node_id}: {drive.state.value}); "
            f"error code {drive.error_code or drive.emergency:#06x}"
        ) from error
    drive.error_code = drive.emergency = 0
