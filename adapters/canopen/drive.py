"""One CiA 402 drive as the control thread sees it: its last state, and the frame that commands it."""

from math import isfinite

from fricomp.errors import AdapterValueError
from fricomp.joint import CommandMode

from ..link import CanFrame
from ..wrapping import CountUnwrapper, wrap_count
from .fault import FAULT_MODE, FAULT_NOT_ENABLED, FAULT_RESTARTED
from .process_data import STATE_PACKERS, Identifiers, command_packer
from .scaling import DriveScaling
from .service import ServiceChannel
from .state_machine import DISABLE_VOLTAGE, STATE_OF_BITS, DriveState, decode_state

__all__ = ["MODE_NUMBERS", "OPERATIONAL", "CanOpenDrive"]

MODE_NUMBERS: dict[CommandMode, int] = {"position": 8, "velocity": 9, "torque": 10}
"""Cyclic synchronous modes of object 6060."""

BOOT_UP, OPERATIONAL = 0, 5
HEALTHY = (None, OPERATIONAL)
ENABLED = DriveState.OPERATION_ENABLED
MOTION, CONDITION = STATE_PACKERS
HIGHEST_COUNT = 0x7FFFFFFF
FARTHEST_COUNT = 1 << 52
"""Of a position that goes on beyond the 32 bits of the wire: what a float tells from its neighbours."""


class CanOpenDrive:
    """State and command of one drive.

    Args:
        node_id: Its node.
        service: To its objects.
    """

    def __init__(self, node_id: int, service: ServiceChannel) -> None:
        self.node_id = node_id
        self.service = service
        self.identifiers = Identifiers(0x200 + node_id, (0x180 + node_id, 0x280 + node_id))
        self.scaling: DriveScaling
        self.state = DriveState.NOT_READY
        self.position_count = self.velocity_count = self.torque_count = 0
        self.turns = CountUnwrapper()
        self.error_code = self.emergency = self.mode_display = 0
        self.nmt_state: int | None = None
        self.heard_ns: int | None = None
        self.restarted = False
        self.max_torque_found: int | None = None  # in 6072, before our own limit was written there
        self.use_mode("torque")

    def use_mode(self, mode: CommandMode) -> None:
        """Pack commands for a mode."""
        self._mode = mode
        self._mode_number = MODE_NUMBERS[mode]
        self._packer = command_packer(mode)

    def take_motion(self, data: bytes) -> None:
        """Take in the first TPDO, of the right length."""
        statusword, position_count, self.torque_count = MOTION.unpack(data)
        self.position_count = self.turns.unwrap(position_count)
        self.state = STATE_OF_BITS[statusword & 0x7F]

    def take_condition(self, data: bytes) -> None:
        """Take in the second TPDO, of the right length."""
        self.velocity_count, self.error_code, self.mode_display = CONDITION.unpack(data)

    def take_statusword(self, statusword: int) -> None:
        """Take in a statusword read by SDO."""
        self.state = decode_state(statusword)

    def take_heartbeat(self, data: bytes, now_ns: int) -> None:
        """Take in a heartbeat; a boot-up message means that the drive has lost its configuration."""
        if len(data) == 1:
            self.nmt_state, self.heard_ns = data[0] & 0x7F, now_ns
            self.restarted = self.restarted or self.nmt_state == BOOT_UP

    def take_emergency(self, data: bytes) -> None:
        """Take in an EMCY; code 0 says that the error is gone."""
        if len(data) == 8:
            self.emergency = int.from_bytes(data[:2], "little")

    def find_fault(self, running: bool) -> int:
        """The drive's error code, or what is wrong although the drive does not call it an error; 0 for nothing."""
        if running and self.state is ENABLED and self.nmt_state in HEALTHY and self.mode_display == self._mode_number:
            return FAULT_RESTARTED if self.restarted else self.emergency
        if self.state in (DriveState.FAULT, DriveState.FAULT_REACTION_ACTIVE):
            return self.error_code or self.emergency or FAULT_NOT_ENABLED
        if not running:
            return 0
        if self.restarted or self.nmt_state not in (None, OPERATIONAL):
            return FAULT_RESTARTED
        if self.emergency:
            return self.emergency
        if self.state is not DriveState.OPERATION_ENABLED:
            return FAULT_NOT_ENABLED
        return 0 if self.mode_display == MODE_NUMBERS[self._mode] else FAULT_MODE

    def command(self, controlword: int, torque: float, velocity: float, position: float) -> CanFrame:
        """The RPDO for a torque [N·m], or a reference with torque as its offset, at the motor.

        Raises:
            AdapterValueError: A value is not finite.
        """
        scaling = self.scaling
        tau = to_count(torque, scaling.torque, scaling.highest_torque_count)
        if self._mode == "torque":
            return self._frame(controlword, tau)
        if self._mode == "velocity":
            return self._frame(controlword, to_count(velocity, scaling.velocity, HIGHEST_COUNT), tau)
        return self._frame(controlword, wrap_count(to_count(position, scaling.position, FARTHEST_COUNT)), tau)

    def resting_command(self, controlword: int) -> CanFrame:
        """The RPDO for no torque, at standstill, where the drive is."""
        if self._mode == "torque":
            return self._frame(controlword, 0)
        return self._frame(controlword, 0 if self._mode == "velocity" else wrap_count(self.position_count), 0)

    def _frame(self, controlword: int, *counts: int) -> CanFrame:
        return CanFrame(self.identifiers.command, self._packer.pack(controlword, *counts))

    def disable_frame(self) -> CanFrame:
        """Write the controlword through SDO without waiting: works when no SYNC gets through to a PDO any more."""
        return CanFrame(0x600 + self.node_id, bytes((0x2B, 0x40, 0x60, 0, DISABLE_VOLTAGE, 0, 0, 0)))


def to_count(value: float, count: float, highest: int) -> int:
    """The nearest count; what is beyond the range gets its edge.

    Raises:
        AdapterValueError: `value` is not finite.
    """
    counts = value / count
    if -highest <= counts <= highest:
        return round(counts)
    if not isfinite(value):
        raise AdapterValueError(f"{value} cannot be sent to a drive")
    return highest if counts > 0.0 else -highest
