"""A moteus controller, from mjbots' reference manual.

Frames are made of subframes: registers are written (0x00..), read (0x10..) and answered
(0x20..) as 8, 16, 32 bit integers or floats, in revolutions, hertz and N·m at the output. The smallest integer and
a float NaN mean "not given". A position command lapses after its timeout (0.1 s unless told otherwise) into mode 11,
which only a stop command leaves.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, isnan, nan, pi
from typing import Any

from fricomp.errors import ParameterError

from ..axis import DriveAxis
from .frame import (
    LONGEST_FRAME,
    Failure,
    Read,
    StreamPoll,
    StreamWrite,
    Write,
    encode_reply,
    encode_stream,
    parse_frame,
)

__all__ = ["BROADCAST", "LONGEST_LINE", "MoteusController", "MoteusSettings"]

TURN = 2.0 * pi
STOPPED, FAULT, CURRENT, POSITION, TIMEOUT, ZERO_VELOCITY, STAY_WITHIN, BRAKE = 0, 1, 9, 10, 11, 12, 13, 15
# Modes that lapse, by the register of their timeout; a current and a brake last until something else is commanded.
LAPSING = {POSITION: 0x027, ZERO_VELOCITY: 0x027, STAY_WITHIN: 0x046}
COMMANDED = (*LAPSING, CURRENT, BRAKE)
MODE, COMMANDS = 0x000, (0x01C, 0x01D, *range(0x020, 0x02A), *range(0x040, 0x049))
Q_CURRENT, TORQUE_CONSTANT = 0x01C, 0.1  # of the motor [N·m/A]
LOWER, UPPER, WITHIN_TORQUE, WITHIN_KP, WITHIN_KD, WITHIN_MAX_TORQUE = range(0x040, 0x046)
TARGET, VELOCITY, TORQUE, KP_SCALE, KD_SCALE, MAX_TORQUE, STOP_POSITION, TIMEOUT_S = range(0x020, 0x028)
DEFAULTS = {KP_SCALE: 1.0, KD_SCALE: 1.0, VELOCITY: 0.0, TORQUE: 0.0}
LONGEST_LINE = 512
BROADCAST = 0x7F


@dataclass(frozen=True)
class MoteusSettings:
    """What is stored in a controller.

    Attributes:
        identifier: 1 to 126.
        default_timeout: servo.default_timeout_s [s].
        timeout_mode: servo.timeout_mode, what mode 11 does: 0 stops, 12 holds zero velocity (as delivered).
    """

    identifier: int = 1
    default_timeout: float = 0.1
    timeout_mode: int = ZERO_VELOCITY

    def __post_init__(self) -> None:
        if not 1 <= self.identifier < BROADCAST:
            raise ParameterError(f"identifier must be from 1 to 126, got {self.identifier!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return inf, inf

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {"id": self.identifier}


class MoteusController:
    """One controller.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
        period: Time between ticks [s].
    """

    def __init__(self, axis: DriveAxis, settings: MoteusSettings = MoteusSettings(), period: float = 1e-3) -> None:
        self.axis, self.settings, self._period = axis, settings, period
        self.power_cycle()

    def power_cycle(self) -> None:
        """Stopped, configuration as stored."""
        stiffness, damping = self.axis.loop_gains
        self.mode, self.fault = STOPPED, 0
        self.configuration: dict[str, float] = {
            "id.id": self.settings.identifier,
            "servo.default_timeout_s": self.settings.default_timeout,
            "servo.timeout_mode": self.settings.timeout_mode,
            "servo.pid_position.kp": stiffness * TURN,
            "servo.pid_position.kd": damping * TURN,
            "servo.max_velocity": self.axis.velocity_limit / TURN,
        }
        self._command = dict.fromkeys(COMMANDS, nan)
        self._new_mode: int | None = None
        self._target = nan
        self._left = 0.0
        self._output = b""
        self._partial = b""
        self.axis.disable()

    def fail(self, code: int) -> None:
        """Go limp with a fault, which a stop command clears."""
        self.mode, self.fault = FAULT, code
        self.axis.disable()

    def frame(self, data: bytes) -> bytes:
        """Obey a frame; its answer, empty where it asks for nothing, cut off where a frame is full."""
        answer, self._new_mode = b"", None
        for subframe in parse_frame(data):
            part = self._obey(subframe)
            if len(answer) + len(part) <= LONGEST_FRAME:
                answer += part
        if self._new_mode is not None:
            self._enter(self._new_mode)
        return answer

    def _obey(self, subframe: Write | Read | StreamWrite | StreamPoll) -> bytes:
        if isinstance(subframe, Read):
            return self._read(subframe)
        if isinstance(subframe, Write):
            return self._write(subframe)
        if isinstance(subframe, StreamWrite):
            self._diagnose(subframe.data)
            return encode_stream(subframe.channel, b"")
        chunk, self._output = self._output[: subframe.longest], self._output[subframe.longest :]
        return encode_stream(subframe.channel, chunk)

    def _write(self, subframe: Write) -> bytes:
        """A mode starts a new command; nothing else in a frame counts without one."""
        if subframe.register == MODE and isfinite(subframe.value):
            self._new_mode = int(subframe.value)
            self._command = {register: DEFAULTS.get(register, nan) for register in COMMANDS}
        elif subframe.register in self._command:
            self._command[subframe.register] = subframe.value
        else:
            return Failure(0x30, subframe.register, 1).encode()
        return b""

    def tick(self, now_ns: int) -> None:
        """Advance the target, and let a command lapse."""
        if self.mode not in LAPSING:
            if self.mode == TIMEOUT and self.axis.energised:
                self.axis.command(0.0)
            return
        self._left -= self._period
        if self._left < 0.0:
            self._lapse()
        else:
            self._drive(self._period)

    def _enter(self, mode: int) -> None:
        if mode == STOPPED:
            self.mode, self.fault = STOPPED, 0
            self.axis.disable()
            return
        if self.mode in (FAULT, TIMEOUT) or mode not in COMMANDED:
            return  # only a stop leaves a fault or a timeout
        if self.mode == STOPPED:
            self.axis.enable("impedance")
        timeout = self._command[LAPSING.get(mode, TIMEOUT_S)]
        self._left = self.configuration["servo.default_timeout_s"] if isnan(timeout) else timeout
        given = self._command[TARGET]
        if not isnan(given):
            self._target = given
        elif self.mode != POSITION or isnan(self._target):
            self._target = self.axis.position / TURN
        self.mode = mode
        self._drive(0.0)

    def _lapse(self) -> None:
        self.mode = TIMEOUT
        if self.configuration["servo.timeout_mode"] == STOPPED:
            self.axis.disable()
            return
        self.axis.command_gains(0.0, self.configuration["servo.pid_position.kd"] / TURN)
        self.axis.command(0.0)

    def _drive(self, elapsed: float) -> None:
        """What the mode commands after `elapsed` [s]."""
        if self.mode == CURRENT:
            current = _or(self._command[Q_CURRENT], 0.0)
            self._push(0.0, 0.0, TORQUE_CONSTANT * current, inf)
        elif self.mode == BRAKE:  # shorted phases: how much they damp is the motor's, here as much as the position loop
            self._push(0.0, self.configuration["servo.pid_position.kd"], 0.0, inf)
        elif self.mode == STAY_WITHIN:
            self._stay_within()
        else:
            self._follow(elapsed)

    def _push(self, kp: float, kd: float, torque: float, most: float, velocity: float = 0.0) -> None:
        """Gains [N·m/turn], [N·m·s/turn], torque and its bound [N·m], velocity [turn/s], about the target."""
        target = 0.0 if isnan(self._target) else self._target
        self.axis.command_gains(kp / TURN, kd / TURN)
        self.axis.limit_torque(most)
        self.axis.command(torque if isfinite(torque) else 0.0, velocity * TURN, target * TURN)

    def _stay_within(self) -> None:
        """Feed-forward torque between the bounds, and the position loop towards the nearer one beyond them."""
        c, at = self._command, self.axis.position / TURN
        lower, upper = _or(c[LOWER], -inf), _or(c[UPPER], inf)
        self._target = min(max(at, lower), upper)
        is_beyond = at != self._target
        kp = self.configuration["servo.pid_position.kp"] * _or(c[WITHIN_KP], 1.0) if is_beyond else 0.0
        kd = self.configuration["servo.pid_position.kd"] * _or(c[WITHIN_KD], 1.0) if is_beyond else 0.0
        self._push(kp, kd, _or(c[WITHIN_TORQUE], 0.0), _or(c[WITHIN_MAX_TORQUE], inf))

    def _follow(self, elapsed: float) -> None:
        """Position loop: the target moves at the commanded velocity up to the stop position."""
        c = self._command
        velocity = 0.0 if self.mode == ZERO_VELOCITY or isnan(c[VELOCITY]) else c[VELOCITY]
        limit = self.configuration["servo.max_velocity"]
        velocity = max(-limit, min(limit, velocity))
        self._target += velocity * elapsed
        stop = c[STOP_POSITION]
        if not isnan(stop) and (self._target - stop) * velocity >= 0.0:
            self._target, velocity = stop, 0.0
        kp = 0.0 if self.mode == ZERO_VELOCITY else self.configuration["servo.pid_position.kp"] * _or(c[KP_SCALE], 1.0)
        kd = self.configuration["servo.pid_position.kd"] * _or(c[KD_SCALE], 1.0)
        self._push(kp, kd, _or(c[TORQUE], 0.0), _or(c[MAX_TORQUE], inf), velocity)

    def _read(self, request: Read) -> bytes:
        value = self._value(request.register)
        if value is None:
            return Failure(0x31, request.register, 1).encode()
        return encode_reply(request.register, request.kind, value)

    def _value(self, register: int) -> float | None:
        axis = self.axis
        values: dict[int, float] = {
            MODE: self.mode,
            0x001: axis.position / TURN,
            0x002: axis.velocity / TURN,
            0x003: axis.torque,
            0x004: axis.torque / TORQUE_CONSTANT,
            0x005: 0.0,
            0x00A: axis.temperature,
            0x00B: 0,
            0x00D: 24.0,
            0x00E: axis.temperature,
            0x00F: self.fault,
            0x100: 0,
            0x101: 0x000106,
            0x102: 5,
            0x110: self.settings.identifier,
            0x120: 0x12345678,
            0x121: 0x23456789,
            0x122: 0x34567890,
        }
        return values.get(register, self._command.get(register))

    def _diagnose(self, data: bytes) -> None:
        """Lines of the diagnostic channel."""
        *lines, self._partial = (self._partial + data).split(b"\n")
        self._partial = self._partial[-LONGEST_LINE:]
        for line in lines:
            self._output += self._diagnostic_answer(line.decode("ascii", "replace").split()) + b"\r\n"

    def _diagnostic_answer(self, words: Sequence[str]) -> bytes:
        match words:
            case ["conf", "get", name] if name in self.configuration:
                return f"{self.configuration[name]:.9g}".encode()
            case ["conf", "set", name, value] if name in self.configuration:
                try:
                    self.configuration[name] = float(value)
                except ValueError:
                    return b"ERR error setting"
                return b"OK"
            case ["conf", "write"] | ["tel", "stop"] | ["d", "nearest" | "exact", _]:
                return b"OK"
            case ["d", "stop"]:
                self._enter(STOPPED)
                return b"OK"
        return b"ERR unknown command"


def _or(value: float, default: float) -> float:
    return default if isnan(value) else value
