"""A Dynamixel X-series servo, from the vendor's manual of the XM430-W350.

Everything is a table of bytes: the EEPROM part can be written only with the torque off. The bus watchdog (98, 20 ms
a count, off as delivered) is fed by any instruction to the servo; once it has fired, goals are refused until it is
written 0. Current is 2.69 mA, velocity 0.229 rpm, position 2 pi/4096 a count: amperes, not N·m.

Switching the operating mode sets goal current to the current limit; switching the torque on leaves the goals as they
are. Goal current bounds current-based position (mode 5) only: the loops of velocity and of the other position modes
end in a voltage.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Any

from fricomp.errors import ParameterError

from ...stand_in.servo import ServoMode
from ..axis import DriveAxis
from .packet import StatusError
from .table import (
    BAUD_RATE,
    CURRENT_LIMIT,
    EEPROM_END,
    GOAL_CURRENT,
    GOAL_POSITION,
    GOAL_VELOCITY,
    HARDWARE_ERROR,
    ID,
    INDIRECT_ADDRESS,
    INDIRECT_DATA,
    OPERATING_MODE,
    TABLE,
    TABLE_SIZE,
    TORQUE_ENABLE,
    VELOCITY_LIMIT,
    WATCHDOG,
)

__all__ = ["CURRENT_UNIT", "VELOCITY_UNIT", "DynamixelServo", "DynamixelSettings"]

CURRENT_UNIT = 2.69e-3
VELOCITY_UNIT = 0.229 * 2.0 * pi / 60.0
POSITION_UNIT = 2.0 * pi / 4096.0
COUNTS_A_TURN = 4096
WATCHDOG_COUNT_NS = 20_000_000
CLEAR_TURNS = bytes((1, 0x44, 0x58, 0x4C, 0x22))  # what the manual asks for, against clearing by mistake
OVERLOAD = 0x20

MODES: dict[int, ServoMode] = {0: "torque", 1: "velocity", 3: "position", 4: "position", 5: "position"}


@dataclass(frozen=True)
class DynamixelSettings:
    """What is stored in a servo.

    Attributes:
        identifier: 0 to 252.
        torque_constant: Joint torque for one ampere [N·m/A]; 1.78 for the XM430-W350 from its performance graph.
        operating_mode: 0 current, 1 velocity, 3 position, 4 extended position, 5 current-based position.
        current_limit: Address 38 [2.69 mA].
        velocity_limit: Address 44 [0.229 rpm].
    """

    identifier: int = 1
    torque_constant: float = 1.78
    operating_mode: int = 3
    current_limit: int = 1193
    velocity_limit: int = 415

    def __post_init__(self) -> None:
        if not 0 <= self.identifier <= 252:
            raise ParameterError(f"identifier must be from 0 to 252, got {self.identifier!r}")
        if not self.torque_constant > 0.0:
            raise ParameterError(f"torque_constant must be positive, got {self.torque_constant!r}")
        if self.operating_mode not in MODES:
            raise ParameterError(f"operating_mode must be one of {sorted(MODES)}, got {self.operating_mode!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return self.current_limit * CURRENT_UNIT * self.torque_constant, self.velocity_limit * VELOCITY_UNIT

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {"id": self.identifier, "torque_constant": self.torque_constant}


class DynamixelServo:
    """One servo.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
    """

    def __init__(self, axis: DriveAxis, settings: DynamixelSettings = DynamixelSettings()) -> None:
        self.axis, self.settings = axis, settings
        self._stored = {ID: settings.identifier, OPERATING_MODE: settings.operating_mode}
        self._stored |= {CURRENT_LIMIT: settings.current_limit, VELOCITY_LIMIT: settings.velocity_limit}
        self.table = bytearray(TABLE_SIZE)
        for address, entry in TABLE.items():
            self._put(address, self._stored.get(address, entry.default))
        self.power_cycle()

    @property
    def identifier(self) -> int:
        """The id it answers to."""
        return self.table[ID]

    @property
    def alert(self) -> int:
        """Bit 7 of every status: there is a hardware error."""
        return 0x80 if self.table[HARDWARE_ERROR] else 0

    def power_cycle(self) -> None:
        """Torque off; the EEPROM keeps its contents, the rest is as delivered."""
        for address, entry in TABLE.items():
            if address >= EEPROM_END:
                self._put(address, entry.default)
        self._put(GOAL_CURRENT, self._get(CURRENT_LIMIT))  # the manual gives no initial value: the worst
        self._silence_ns = self._now_ns = 0
        self._forget_turns()
        self._pending: tuple[int, bytes] | None = None
        self.axis.disable()

    def fail(self, error: int = OVERLOAD) -> None:
        """Go limp with a hardware error, which only a reboot clears."""
        self.table[HARDWARE_ERROR] |= error
        self.table[TORQUE_ENABLE] = 0
        self.axis.disable()

    def feed(self) -> None:
        """An instruction to this servo has come."""
        self._silence_ns = 0

    def tick(self, now_ns: int) -> None:
        """Bus watchdog."""
        if self._now_ns:
            self._silence_ns += now_ns - self._now_ns
        self._now_ns = now_ns
        counts = self.table[WATCHDOG]
        if 0 < counts <= 127 and self.table[TORQUE_ENABLE] and self._silence_ns > counts * WATCHDOG_COUNT_NS:
            self.table[WATCHDOG] = 0xFF
            for address in (GOAL_CURRENT, GOAL_VELOCITY):
                self._put(address, 0)
            self.axis.disable()
            self.axis.enable("torque")

    def read(self, address: int, length: int) -> tuple[int, bytes]:
        """Bytes of the table, with what is measured up to date."""
        if length == 0 or address + length > TABLE_SIZE:
            return StatusError.DATA_RANGE, b""
        self._measure()
        return 0, bytes(self.table[self._shown_at(each)] for each in range(address, address + length))

    def write(self, address: int, data: bytes) -> int:
        """Write whole items; returns the error of the status."""
        if not data or address + len(data) > TABLE_SIZE:
            return StatusError.DATA_RANGE
        changes: list[tuple[int, int]] = []
        at = address
        while at < address + len(data):
            entry = TABLE.get(at)
            if entry is None:
                at += 1  # between items: ignored
                continue
            if entry.highest is None:
                return StatusError.ACCESS
            raw = data[at - address : at - address + entry.size]
            if len(raw) < entry.size:
                return StatusError.DATA_LENGTH
            value = int.from_bytes(raw, "little", signed=entry.lowest < 0)
            if not entry.lowest <= value <= entry.highest:
                return StatusError.DATA_LIMIT
            changes.append((at, value))
            at += entry.size
        return self._apply(changes)

    def hold(self, address: int, data: bytes) -> int:
        """Keep a write for the action instruction."""
        self._pending = address, data
        self.table[69] = 1
        return 0

    def act(self) -> int:
        """Carry out the kept write."""
        pending, self._pending = self._pending, None
        self.table[69] = 0
        return self.write(*pending) if pending is not None else StatusError.RESULT_FAIL

    def reset(self, option: int) -> int:
        """Factory reset of the whole table (0xFF), all but the id (1), or all but id and baud rate (2); and restart."""
        kept = {0xFF: (), 1: (ID,), 2: (ID, BAUD_RATE)}.get(option)
        if kept is None:
            return StatusError.DATA_RANGE
        for address, entry in TABLE.items():
            if address not in kept:
                self._put(address, entry.default)
        self.power_cycle()
        return 0

    def clear_turns(self, parameters: bytes) -> int:
        """Position within one turn again, of a servo that stands still."""
        if parameters != CLEAR_TURNS:
            return StatusError.DATA_RANGE
        if abs(self.axis.velocity) > 0.5 * VELOCITY_UNIT:
            return StatusError.RESULT_FAIL
        self._forget_turns()
        return 0

    def _forget_turns(self) -> None:
        """The encoder knows its place within one turn only, the middle of which a homing offset has put to zero."""
        self._turns = round(self.axis.position / (2.0 * pi))

    def _apply(self, changes: Sequence[tuple[int, int]]) -> int:
        for address, value in changes:
            error = self._refuse(address, value)
            if error:
                return error
        for address, value in changes:
            if address == TORQUE_ENABLE and self.table[TORQUE_ENABLE] and value:
                continue  # already on: the goals stay
            self._put(address, value)
            if address == OPERATING_MODE:
                self._put(GOAL_CURRENT, self._get(CURRENT_LIMIT))
            elif address == TORQUE_ENABLE:
                self._switch(bool(value))
            elif address in (GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION) and self.table[TORQUE_ENABLE]:
                self._command()
        return 0

    def _refuse(self, address: int, value: int) -> int:
        if address < EEPROM_END and self.table[TORQUE_ENABLE]:
            return StatusError.ACCESS
        if 100 <= address <= 116 and self.table[WATCHDOG] == 0xFF:
            return StatusError.DATA_RANGE
        if address == OPERATING_MODE and value not in MODES:
            return StatusError.DATA_LIMIT
        for goal, limit in ((GOAL_CURRENT, CURRENT_LIMIT), (GOAL_VELOCITY, VELOCITY_LIMIT)):
            if address == goal and abs(value) > self._get(limit):
                return StatusError.DATA_LIMIT
        if address == TORQUE_ENABLE and value and self.table[HARDWARE_ERROR]:
            return StatusError.ACCESS
        return 0

    def _switch(self, on: bool) -> None:
        if not on:
            self.axis.disable()
            return
        self.feed()
        self.axis.enable(MODES[self.table[OPERATING_MODE]])
        self._command()

    def _command(self) -> None:
        mode, constant = self.table[OPERATING_MODE], self.settings.torque_constant
        current = self._get(GOAL_CURRENT) * CURRENT_UNIT
        self.axis.limit_torque(abs(current) * constant if mode == 5 else inf)
        torque = current * constant if mode == 0 else 0.0
        position = self._get(GOAL_POSITION) * POSITION_UNIT + self._turns * 2.0 * pi
        self.axis.command(torque, self._get(GOAL_VELOCITY) * VELOCITY_UNIT, position)

    def _shown_at(self, address: int) -> int:
        """Where the byte at an address comes from: elsewhere, if it is an indirect datum."""
        indirect = address - INDIRECT_DATA
        return self._get(INDIRECT_ADDRESS + 2 * indirect) if indirect >= 0 else address

    def _measure(self) -> None:
        axis, most = self.axis, 32767
        current = round(axis.torque / self.settings.torque_constant / CURRENT_UNIT)
        self._put(120, (self._now_ns // 1_000_000) % 32768)
        self._put(126, max(-most, min(most, current)))
        self._put(128, round(axis.velocity / VELOCITY_UNIT))
        self._put(132, round(axis.position / POSITION_UNIT) - COUNTS_A_TURN * self._turns)  # goes on at -2^31
        self._put(122, int(abs(axis.velocity) > 10 * VELOCITY_UNIT))
        self.table[146] = max(0, min(255, round(axis.temperature)))

    def _put(self, address: int, value: int) -> None:
        size = TABLE[address].size
        self.table[address : address + size] = (value & ((1 << 8 * size) - 1)).to_bytes(size, "little")

    def _get(self, address: int) -> int:
        entry = TABLE[address]
        raw = self.table[address : address + entry.size]
        return int.from_bytes(raw, "little", signed=entry.lowest < 0)
