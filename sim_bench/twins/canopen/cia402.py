"""A CiA 402 drive: cyclic synchronous position, velocity and torque over CANopen [cia402].

Position and velocity in encoder increments of the motor, torque in thousandths of 6076. When the master's heartbeat
(0x1016) fails, or NMT leaves operational, 6007 says what happens: nothing, fault, disable voltage or quick stop.
"""

from dataclasses import dataclass
from math import inf, pi
from typing import Any

from fricomp.errors import ParameterError

from ...stand_in.servo import ServoMode
from ..axis import DriveAxis
from .cia402_state import DriveState, next_state, status_word
from .node import CanopenNode

__all__ = ["Cia402Drive", "Cia402Settings"]

MODES: dict[int, ServoMode] = {8: "position", 9: "velocity", 10: "torque"}
CONTROLWORD, STATUSWORD, MODE, MODE_DISPLAY, ABORT_OPTION = 0x6040, 0x6041, 0x6060, 0x6061, 0x6007
TARGET_TORQUE, TORQUE_OFFSET, MAX_TORQUE, TARGET_POSITION = 0x6071, 0x60B2, 0x6072, 0x607A
TARGET_VELOCITY, VELOCITY_OFFSET = 0x60FF, 0x60B1
TARGETS = (TARGET_TORQUE, TORQUE_OFFSET, MAX_TORQUE, TARGET_POSITION, TARGET_VELOCITY, VELOCITY_OFFSET)
NOTHING, FAULT, DISABLE_VOLTAGE, QUICK_STOP = range(4)
AT_REST = 0.01


@dataclass(frozen=True)
class Cia402Settings:
    """What is stored in a drive.

    Attributes:
        node_id: 1 to 127.
        rated_torque: 6076, of the motor [N·m]; torque is counted in thousandths of it.
        encoder_increments: 608F, increments of one motor turn.
    """

    node_id: int = 1
    rated_torque: float = 1.0
    encoder_increments: int = 2**18

    def __post_init__(self) -> None:
        if not 1 <= self.node_id <= 127:
            raise ParameterError(f"node_id must be from 1 to 127, got {self.node_id!r}")
        if not self.rated_torque >= 1e-3:
            raise ParameterError(f"rated_torque must be at least 1e-3 N·m, got {self.rated_torque!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return 32.767 * self.rated_torque, inf

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {"id": self.node_id}


class Cia402Drive(CanopenNode):
    """One drive.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
    """

    def __init__(self, axis: DriveAxis, settings: Cia402Settings = Cia402Settings()) -> None:
        self.axis, self.settings = axis, settings
        self._increments = settings.encoder_increments / (2.0 * pi)
        super().__init__(settings.node_id)
        self.on_reset()

    def on_reset(self) -> None:
        """As delivered, de-energised."""
        self.state, self.error_code = DriveState.SWITCH_ON_DISABLED, 0
        self.mode = 0
        self._controlword = 0
        self.axis.disable()
        gear = max(1, round(self.axis.gear_ratio * 1000))
        most = min(65535, round(1000.0 * self.axis.torque_limit / self.settings.rated_torque))
        for index, subindex, value in (
            (0x6076, 0, round(self.settings.rated_torque * 1000.0)),
            (MAX_TORQUE, 0, most),
            (0x608F, 1, self.settings.encoder_increments),
            (0x6091, 1, gear),
            (0x6091, 2, 1000),
            (0x6092, 1, round(self.settings.encoder_increments * gear / 1000)),
            (0x6080, 0, round(self.axis.velocity_limit * 30.0 / pi)),
        ):
            self.store(index, subindex, value)
        self._target = {index: self.stored(index) for index in TARGETS}

    def fail(self, code: int) -> None:
        """Go limp with a fault, which a fault reset clears; send the emergency message."""
        self.emergency(code, 0x01)
        self._fault(code)

    def on_object_written(self, index: int, subindex: int, value: int) -> None:
        """Controlword, mode and targets."""
        if index == CONTROLWORD:
            self._control(value)
        elif index == MODE:
            self._set_mode(value)
        elif index in self._target:
            self._target[index] = value
            self._command()

    def object_value(self, index: int, subindex: int) -> int | None:
        """Everything the drive measures."""
        axis = self.axis
        if index == STATUSWORD:
            return status_word(self.state, follows=self.mode in MODES)
        if index == MODE_DISPLAY:
            return self.mode
        if index == 0x6064:
            return _wrap(round(axis.position * self._increments))
        if index == 0x606C:
            return _clamp(round(axis.velocity * self._increments), 32)
        if index in (0x6077, 0x6078):
            return _clamp(round(1000.0 * axis.torque / self.settings.rated_torque), 16)
        if index == 0x603F:
            return self.error_code
        if index == 0x1001:
            return 1 if self.state is DriveState.FAULT else 0
        return None

    def on_connection_lost(self, code: int) -> None:
        """React as 6007 says, if the motor is energised."""
        if self.state not in (DriveState.OPERATION_ENABLED, DriveState.QUICK_STOP_ACTIVE):
            return
        reaction = self.stored(ABORT_OPTION)
        if reaction == FAULT:
            self._fault(code or 0x8100)
        elif reaction == DISABLE_VOLTAGE:
            self._enter(DriveState.SWITCH_ON_DISABLED)
        elif reaction == QUICK_STOP:
            self._enter(DriveState.QUICK_STOP_ACTIVE)

    def tick(self, now_ns: int) -> None:
        """A quick stop ends, limp, once the joint rests."""
        super().tick(now_ns)
        if self.state is DriveState.QUICK_STOP_ACTIVE and abs(self.axis.velocity / self.axis.gear_ratio) < AT_REST:
            self._enter(DriveState.SWITCH_ON_DISABLED)

    def _control(self, word: int) -> None:
        before, self._controlword = self._controlword, word
        state = next_state(self.state, word, before)
        if self.state is DriveState.FAULT and state is not DriveState.FAULT:
            self.error_code = 0
            self.emergency(0, 0)
        if state is DriveState.OPERATION_ENABLED and self.mode not in MODES:
            state = self.state  # no mode chosen: stays where it is
        if state is not self.state:
            self._enter(state)

    def _enter(self, state: DriveState) -> None:
        self.state = state
        if state is DriveState.OPERATION_ENABLED:
            self._energise()
        elif state is DriveState.QUICK_STOP_ACTIVE and self.stored(0x605A) != 0:
            self.axis.enable("velocity")
            self._limit_torque()
        else:
            self.axis.disable()

    def _fault(self, code: int) -> None:
        self.error_code = code
        self._enter(DriveState.FAULT)

    def _set_mode(self, mode: int) -> None:
        if mode not in MODES and mode != 0:
            return  # not supported: 6061 keeps the mode in force
        changed, self.mode = mode != self.mode, mode
        if changed and self.state is DriveState.OPERATION_ENABLED:
            if mode in MODES:
                self._energise()
            else:
                self._enter(DriveState.SWITCHED_ON)

    def _energise(self) -> None:
        self.axis.enable(MODES[self.mode])
        self._command()

    def _command(self) -> None:
        if self.state is not DriveState.OPERATION_ENABLED:
            return
        t, unit = self._target, self.settings.rated_torque / 1000.0
        permille = t[TORQUE_OFFSET] + (t[TARGET_TORQUE] if self.mode == 10 else 0)
        most = t[MAX_TORQUE]
        velocity = t[TARGET_VELOCITY] + t[VELOCITY_OFFSET]
        self._limit_torque()
        self.axis.command(
            max(-most, min(most, permille)) * unit,
            velocity / self._increments,
            t[TARGET_POSITION] / self._increments,
        )

    def _limit_torque(self) -> None:
        """Bound the drive's own loop, in every mode and while it brakes."""
        self.axis.limit_torque(self._target[MAX_TORQUE] * self.settings.rated_torque / 1000.0)


def _clamp(value: int, bits: int) -> int:
    highest = (1 << bits - 1) - 1
    return max(-highest - 1, min(highest, value))


def _wrap(value: int) -> int:
    """A position goes on at the other end of its 32 bits, as the counters of drives do."""
    return (value + (1 << 31)) % (1 << 32) - (1 << 31)
