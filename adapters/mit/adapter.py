"""MIT-mode motors as joints: torque commands, a state in answer to each."""

import struct
from collections.abc import Callable, Mapping, Sequence
from math import isclose, isfinite

from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

from ..bus_budget import BusBudget, can_frame_bits
from ..can_adapter import CanAdapter
from ..link import CanFrame, CanLink
from .configuration import MitConfiguration, make_motor
from .fault import FAULT_NOT_ENABLED, FAULT_POSITION_EDGE
from .motor import MotorState
from .profile import Register, RegisterType
from .velocity_loop import MotorVelocityLoop, loop_gains

__all__ = ["MitAdapter"]

FORMATS: Mapping[RegisterType, str] = {"float32": "<f", "uint32": "<I", "uint8": "<Bxxx"}

ANSWER_NS = 5_000_000
"""How long an answer to a frame of ours may be under way [ns]."""
LISTENING_NS = 50_000_000
"""How long a motor that does not tell its state is listened to [ns]: any control loop commands it meanwhile."""


class MitAdapter(CanAdapter):
    """MIT-mode motors on one CAN bus.

    Args:
        configuration: Bus and motors.
        open_link: Makes the link; python-can as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    configuration_type = MitConfiguration

    def __init__(
        self,
        configuration: MitConfiguration,
        open_link: Callable[[], CanLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock)
        self._configuration = configuration
        self._motors = tuple(make_motor(joint) for joint in configuration.joints)
        self._joints_of: dict[int, list[int]] = {}
        for joint, motor in enumerate(self._motors):
            self._joints_of.setdefault(motor.answer_key, []).append(joint)
        for joints in self._joints_of.values():
            self._refuse_shared_answers(joints)
        self._gains = tuple(
            loop_gains(joint.stiffness, joint.damping, motor, joint.name)
            for joint, motor in zip(configuration.joints, self._motors, strict=True)
        )
        self._loops: list[MotorVelocityLoop] = []
        self._period = 0.0
        self._enabled_ns = 0
        self._edges = [motor.ranges.position - 0.5 * motor.quanta[0] for motor in self._motors]
        self._enabled_flags: list[bool | None] = [None] * len(self._motors)
        self._answers: list[dict[int, bytes]] = [{} for _ in self._motors]
        self._expected: list[int | None] = [None] * len(self._motors)
        self._seen = [False] * len(self._motors)
        self.watchdog_faults = frozenset(motor.lost for motor in self._motors if motor.lost is not None)

    def _refuse_shared_answers(self, joints: Sequence[int]) -> None:
        """Motors that may answer under identifiers of their own must: two that answer at once destroy both frames.

        Raises:
            AdapterConfigurationError: Two of them share one.
        """
        sharing = [joint for joint in joints if self._motors[joint].has_own_feedback_id]
        if len(sharing) > 1:
            names = ", ".join(repr(self._configuration.joints[joint].name) for joint in sharing)
            raise AdapterConfigurationError(
                f"joints {names} have one feedback_id, {self._motors[sharing[0]].feedback_id:#x}: give each motor its "
                f"own master id (register 7), and the same number here"
            )

    # -- opening ------------------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._connect()
        for joint in range(len(self._motors)):
            self._check_ranges(joint)
        self._refuse_held()  # before the first poll, which de-energises a motor that answers nothing but commands
        self._poll_all()
        joints = tuple(map(self._declare, range(len(self._motors))))
        return Capabilities(joints, self._modes(), self._highest_rate(), None)

    def _find_energised(self) -> Sequence[bool | None]:
        """As the motors say; those that answer nothing but commands are listened to.

        Whoever commands one makes it answer. One that is energised and left alone cannot be told from one at rest.
        """
        heard = self._listen()
        self._forget()
        self._send([motor.poll_frame for motor in self._motors if motor.tells_when_asked])
        self._wait(self._all_told, self._response_timeout, f"not all of {self._names_and_ids()} answered")
        rows = zip(self._motors, self._enabled_flags, heard, strict=True)
        return [flag if motor.tells_when_asked else other or None for motor, flag, other in rows]

    def _all_told(self) -> bool:
        return all(seen or not motor.tells_when_asked for motor, seen in zip(self._motors, self._seen, strict=True))

    def _listen(self) -> list[bool]:
        """Which motors answer somebody else, and do not say that they are limp."""
        if all(motor.tells_when_asked for motor in self._motors):
            self._pump()
            return [False] * len(self._motors)
        self.clock.sleep_until(self.clock.now_ns() + ANSWER_NS)  # answers to polls of our own may be on their way
        self._pump()
        self._forget()
        self.clock.sleep_until(self.clock.now_ns() + LISTENING_NS)
        self._pump()
        return [seen and flag is not False for seen, flag in zip(self._seen, self._enabled_flags, strict=True)]

    def _modes(self) -> tuple[CommandMode, ...]:
        return ("torque", "velocity") if all(self._gains) else ("torque",)

    def _declare(self, joint: int) -> JointCapabilities:
        motor = self._motors[joint]
        position, velocity, torque = motor.quanta
        limits = motor.ranges
        return JointCapabilities(
            self._configuration.joints[joint].name,
            position_quantum=position,
            velocity_quantum=velocity,
            torque_quantum=torque,
            torque_limit=limits.torque,
            velocity_limit=limits.velocity - velocity,  # the outermost code also stands for everything faster
            position_limits=(-limits.position, limits.position),
            reports_temperature=isfinite(self._reported.temperature[joint]),  # AK firmware before 2022 does not
        )

    def _highest_rate(self) -> float:
        bits = [2 * can_frame_bits(8, extended=motor.enable_frame.extended) for motor in self._motors]
        bitrate = self._configuration.bus.bitrate
        return BusBudget([n / bitrate for n in bits]).highest_rate

    def _check_ranges(self, joint: int) -> None:
        """Ask the motor for its own ranges: published tables disagree, and a wrong one scales every torque."""
        motor, name = self._motors[joint], self._configuration.joints[joint].name
        for what in ("position", "velocity", "torque"):
            register: Register | None = getattr(motor.registers, what)
            if register is None:
                continue
            theirs, ours = float(self._read_register(joint, register)), getattr(motor.ranges, what)
            if not isclose(theirs, ours, rel_tol=1e-4):
                raise AdapterConfigurationError(
                    f"joint {name!r}: the motor's {what} range is {theirs:g}, the configuration says {ours:g}: "
                    f"correct the model, or give ranges = [position, velocity, torque]"
                )

    # -- registers ----------------------------------------------------------------------------------------

    def _read_register(self, joint: int, register: Register) -> float:
        motor, answers = self._motors[joint], self._answers[joint]
        answers.pop(register.number, None)
        self._expected[joint] = register.number
        try:
            self._send([motor.read_frame(register)])
            self._wait(
                lambda: register.number in answers,
                self._response_timeout,
                f"joint {self._configuration.joints[joint].name!r} (id {motor.address}) did not answer "
                f"about register {register.number:#x}",
            )
        finally:
            self._expected[joint] = None
        return float(struct.unpack(FORMATS[register.type], answers[register.number])[0])

    def _write_register(self, joint: int, register: Register, value: float) -> float:
        """Write and read back; what the motor has then."""
        number = value if register.type == "float32" else round(value)
        self._send([self._motors[joint].write_frame(register, struct.pack(FORMATS[register.type], number))])
        return self._read_register(joint, register)

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._set_modes()
        self._watchdog = self._set_watchdogs()
        self._period = period

    def _set_modes(self) -> None:
        for joint, motor in enumerate(self._motors):
            needed = motor.registers.mode
            if needed is not None and needed.required is not None:
                found = self._write_register(joint, needed, needed.required)
                if found != needed.required:
                    name = self._configuration.joints[joint].name
                    raise AdapterConfigurationError(
                        f"joint {name!r}: the motor stays in mode {found:g}; torque needs {needed.required}"
                    )

    def _set_watchdogs(self) -> Watchdog | None:
        """Give every motor that has one its watchdog; None where one of them has none."""
        wanted, confirmed, all_have = self._configuration.watchdog, True, True
        for joint, motor in enumerate(self._motors):
            register = motor.registers.watchdog
            if register is None:
                all_have = False
                continue
            counts = max(1, round(wanted / register.count))
            confirmed = self._write_register(joint, register, counts) == counts and confirmed
        return Watchdog(wanted, confirmed) if all_have else None

    # -- moving -------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        self._prepare_again()
        self._raise_if_stopped()
        self._pump()
        self._forget()
        # Zero before and after: some firmware goes on with the last command it has ever got.
        for frames in ("zero", "enable", "zero"):
            self._send(
                [motor.enable_frame if frames == "enable" else motor.torque_frame(0.0) for motor in self._motors]
            )
        self._wait(self._all_enabled, self._response_timeout, "not all motors reported to be enabled")
        self._loops = self._make_loops()
        self._enabled_ns = self.clock.now_ns()
        self._running = True

    def _prepare_again(self) -> None:
        """A motor that was power cycled since it was configured has its stored mode, and as a rule no watchdog."""
        self._set_modes()
        kept = self._set_watchdogs()
        if self._watchdog is not None and self._watchdog.confirmed and kept != self._watchdog:
            raise AdapterError("the motors do not keep their watchdog any more: configure() them again")

    def _make_loops(self) -> list[MotorVelocityLoop]:
        """Velocity loops, at rest where the motors are; none where no gains are configured."""
        rows = zip(self._motors, self._gains, self._torques_at_drives(), self._reported.position, strict=True)
        now_ns, period = self.clock.now_ns(), self._period
        return [MotorVelocityLoop(m, g, most, period, at, now_ns=now_ns) for m, g, most, at in rows if g is not None]

    def _all_enabled(self) -> bool:
        self._raise_if_stopped()
        self._raise_on_fault()
        return all(self._seen) and all(flag is not False for flag in self._enabled_flags)

    def _describe_fault(self, joint: int, code: int) -> str:
        return self._motors[joint].describe_fault(code)

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        torque, reported = command.torque, self._reported
        if mode == "torque":
            self._send([motor.torque_frame(torque[joint]) for joint, motor in enumerate(self._motors)])
            return
        share, now_ns = self._ramp_share(), self.clock.now_ns()
        rows = zip(self._loops, command.velocity, torque, reported.position, reported.velocity, strict=True)
        self._send([loop.frame(v, ff, at, moving, share, now_ns=now_ns) for loop, v, ff, at, moving in rows])

    def _ramp_share(self) -> float:
        """Share of the torque limit that the velocity loops may use: the gate ramps nothing but the feed-forward."""
        elapsed, ramp = 1e-9 * (self.clock.now_ns() - self._enabled_ns), self._checked_options.ramp_time
        return 1.0 if elapsed >= ramp else max(elapsed / ramp, 0.0)

    def _ask_state(self) -> None:
        self._send([motor.poll_frame for motor in self._motors])

    def _on_frame(self, frame: CanFrame) -> None:
        for joint in self._joints_of.get(frame.identifier & 0xFFFF, ()):
            motor = self._motors[joint]
            if self._expected[joint] is not None:
                answer = motor.decode_register(frame)
                if answer is not None and answer[0] == self._expected[joint]:
                    self._answers[joint][answer[0]] = answer[1]
                    return
            state = motor.decode(frame)
            if state is not None:
                self._take_state(joint, state)
                return
        self.n_damaged += 1

    def _take_state(self, joint: int, state: MotorState) -> None:
        reported = self._reported
        (
            reported.position[joint],
            reported.velocity[joint],
            reported.torque[joint],
            reported.temperature[joint],
            fault,
            enabled,
        ) = state
        if self._running and not fault:
            # What the motor does not call a fault and yet must stop the joints.
            if enabled is False:
                fault = FAULT_NOT_ENABLED
            elif not -self._edges[joint] <= state.position <= self._edges[joint]:
                fault = FAULT_POSITION_EDGE
        reported.fault[joint] = fault
        self._enabled_flags[joint], self._seen[joint] = enabled, True
        self._arrivals.mark(joint)

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        self._send([motor.torque_frame(0.0) for motor in self._motors])
        self._send([motor.disable_frame for motor in self._motors])

    def _clear_faults(self) -> None:
        self._send([motor.clear_frame for motor in self._motors])
        self._poll_all()
        self._raise_on_fault()

    def _poll_all(self) -> None:
        """Ask all motors for their state and wait for the answers."""
        self._pump()
        self._forget()
        self._ask_state()
        self._wait(lambda: all(self._seen), self._response_timeout, f"not all of {self._names_and_ids()} answered")

    def _forget(self) -> None:
        self._seen = [False] * len(self._motors)
        self._enabled_flags = [None] * len(self._motors)
        self._reported.fault[:] = [0] * len(self._motors)

    def _names_and_ids(self) -> str:
        return ", ".join(f"{joint.name!r} (id {joint.id})" for joint in self._configuration.joints)

    def _health(self) -> dict[str, float | str]:
        return {"foreign_or_damaged_frames": float(self.n_damaged)}
