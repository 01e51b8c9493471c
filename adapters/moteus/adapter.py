"""moteus controllers as joints: a command that lapses by itself, its answer, every cycle."""

from collections.abc import Callable, Sequence

from fricomp.errors import AdapterConfigurationError, AdapterTimeout
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

from ..bus_budget import BusBudget, can_fd_frame_time, serial_time
from ..configuration import JointConfiguration, SerialAdapterConfiguration
from ..link import SerialLink
from ..serial_adapter import SerialAdapter
from .codec import (
    LONGEST_TEXT,
    MODE_FAULT,
    MODE_POSITION,
    MODE_STOPPED,
    MODE_TIMEOUT,
    QUERY,
    STOP,
    MoteusState,
    decode_state,
    decode_text,
    encode_command,
    encode_text,
    pad,
)
from .fault import FAULT_MODE, describe_fault
from .fdcanusb import HEAD_SIZE, CommandLine, LineBuffer, decode_known, decode_line, encode_line, line_heads

__all__ = ["MoteusAdapter", "MoteusConfiguration"]

SETTLING_NS = 20_000_000
TIMEOUT_STOPS = 0  # servo.timeout_mode: the delivered 12 would brake actively
USB_BAUDRATE = 12_000_000
NOTHING_TO_TELL = (b"OK", b"OK\r", b"")


class MoteusConfiguration(SerialAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """moteus controllers behind one fdcanusb; `id` of a joint is the controller's.

    Attributes:
        uart: Whether the line is a real asynchronous one, whose rate then counts in the budget, and not USB.
    """

    joints: tuple[JointConfiguration, ...]
    uart: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for joint in self.joints:
            if not 1 <= joint.id <= 126:
                raise ValueError(f"joint {joint.name!r}: controllers are numbered 1 to 126, got {joint.id}")


class MoteusAdapter(SerialAdapter):
    """moteus controllers behind one fdcanusb.

    Args:
        configuration: Port and controllers.
        open_link: Makes the link; pyserial as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    watchdog_faults = frozenset({FAULT_MODE + MODE_TIMEOUT})

    configuration_type = MoteusConfiguration

    def __init__(
        self,
        configuration: MoteusConfiguration,
        open_link: Callable[[], SerialLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock)
        self._configuration = configuration
        self._addresses = [joint.id for joint in configuration.joints]
        self._joint_of = {address: joint for joint, address in enumerate(self._addresses)}
        self._joint_of_head = {head: joint for source, joint in self._joint_of.items() for head in line_heads(source)}
        self._query = b"".join(encode_line(address, pad(QUERY)) for address in self._addresses)
        self._stop_lines = b"".join(encode_line(address, pad(STOP)) for address in self._addresses)
        self._commands: list[CommandLine] = []
        self._lines = LineBuffer()
        self._texts = [b""] * len(self._addresses)
        self._modes: list[int | None] = [None] * len(self._addresses)

    # -- receiving ------------------------------------------------------------------------------------------

    def _on_bytes(self, data: bytes) -> None:
        joint_of_head = self._joint_of_head
        for line in self._lines.take(data):
            if len(line) <= 3 and line in NOTHING_TO_TELL:
                continue
            joint = joint_of_head.get(line[:HEAD_SIZE])
            content = None if joint is None else decode_known(line)
            state = None if content is None else decode_state(content)
            if joint is not None and state is not None:
                self._take_state(joint, state)
            else:
                self._on_other(line)

    def _on_other(self, line: bytes) -> None:
        """A line that is not the usual answer to a query."""
        frame = decode_line(line)
        joint = None if frame is None else self._joint_of.get(frame.source)
        if frame is None or joint is None:
            self.n_damaged += not line.startswith(b"OK") and bool(line.strip())
        elif (state := decode_state(frame.data)) is not None:
            self._take_state(joint, state)
        elif (text := decode_text(frame.data)) is not None:
            self._texts[joint] = (self._texts[joint] + text)[-4 * LONGEST_TEXT :]
        else:
            self.n_damaged += 1

    def _take_state(self, joint: int, state: MoteusState) -> None:
        reported = self._reported
        mode, reported.position[joint], reported.velocity[joint], torque, temperature, fault = state
        reported.torque[joint], reported.temperature[joint] = torque, temperature
        if self._running and mode != MODE_POSITION and not fault:
            fault = FAULT_MODE + mode
        reported.fault[joint] = fault
        self._modes[joint] = mode
        self._arrivals.mark(joint)

    # -- opening and configuring ------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._connect()
        self._send(b"\n" + self._query)  # the empty line ends whatever was cut short before us
        self._wait(self._arrivals.take, self._response_timeout, f"not all of controllers {self._addresses} answered")
        joints = tuple(JointCapabilities(joint.name) for joint in self._configuration.joints)
        return Capabilities(joints, ("torque", "velocity", "position"), self._highest_rate(), None)

    def _find_energised(self) -> Sequence[bool | None]:
        self._poll_all()
        return [self._is_energised(joint, mode) for joint, mode in enumerate(self._modes)]

    def _is_energised(self, joint: int, mode: int | None) -> bool:
        """Whether a controller carries current; after a timeout it stops or brakes, as it is set to."""
        if mode == MODE_TIMEOUT:
            return not _is_number(self._converse(joint, "conf get servo.timeout_mode"), TIMEOUT_STOPS)
        return mode not in (MODE_STOPPED, MODE_FAULT)

    def _highest_rate(self) -> float:
        baudrate = self._configuration.serial.baudrate if self._configuration.uart else USB_BAUDRATE
        command = pad(encode_command("torque", 0.0, 0.0, 1.0, 0.1))
        answer = len(pad(bytes(22)))
        text = len(encode_line(1, command)) + len(b"OK\n") + len(encode_line(1, bytes(answer))) + len(b" E B F")
        times = (serial_time(text, baudrate), can_fd_frame_time(len(command)), can_fd_frame_time(answer))
        return BusBudget(times * len(self._addresses)).highest_rate

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._mode_in_use, self._running = mode, False
        timeout = self._configuration.watchdog
        self._commands = [
            CommandLine(address, mode, highest, timeout)
            for address, highest in zip(self._addresses, self._torques_at_drives(), strict=True)
        ]
        self._set_timeouts()
        self._watchdog = Watchdog(timeout, True)

    def _set_timeouts(self) -> None:
        """What the controllers do when commands cease, written and read back.

        Raises:
            AdapterConfigurationError: They do not keep it.
        """
        wanted = {"servo.default_timeout_s": self._configuration.watchdog, "servo.timeout_mode": float(TIMEOUT_STOPS)}
        for joint, address in enumerate(self._addresses):
            for name, value in wanted.items():
                self._converse(joint, f"conf set {name} {value:g}")
                found = self._converse(joint, f"conf get {name}")
                if not _is_number(found, value):
                    raise AdapterConfigurationError(
                        f"controller {address} does not keep {name} = {value:g}: read back {found!r}"
                    )

    def _converse(self, joint: int, line: str) -> str:
        """Send a line to the diagnostic channel; the line it answers."""
        self._texts[joint] = b""
        self._send(encode_line(self._addresses[joint], pad(encode_text(line.encode("ascii") + b"\n"))))
        poll = encode_line(self._addresses[joint], pad(encode_text(b"")))

        def answered() -> bool:
            if b"\n" in self._texts[joint]:
                return True
            self._send(poll)
            return False

        complaint = f"controller {self._addresses[joint]} did not answer {line!r}"
        self._wait(answered, self._response_timeout, complaint)
        return self._texts[joint].partition(b"\n")[0].decode("ascii", "replace").strip()

    # -- moving -----------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        self._set_timeouts()  # once more: a controller that was power cycled would brake where it has to stop
        self._raise_if_stopped()
        self._poll_all()  # where the joints are now is where they will be held
        self._modes = [None] * len(self._addresses)
        deadline = self.clock.now_ns() + round(self._response_timeout * 1e9)
        hold = JointCommand(len(self._addresses))
        hold.position[:] = self._reported.position
        while not all(mode == MODE_POSITION for mode in self._modes):
            self._raise_if_stopped()
            self._raise_on_fault()
            if self.clock.now_ns() > deadline:
                raise AdapterTimeout(f"controllers {self._addresses} are in modes {self._modes} instead of position")
            self._write(hold, self._mode_in_use)
            self.clock.sleep_until(self.clock.now_ns() + 1_000_000)
            self._pump()
        self._running = True

    def _describe_fault(self, joint: int, code: int) -> str:
        return describe_fault(code)

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        references = command.position if mode == "position" else command.velocity
        torque = command.torque
        lines = [line.encode(torque[joint], references[joint]) for joint, line in enumerate(self._commands)]
        self._send(b"".join(lines))

    def _ask_state(self) -> None:
        self._send(self._query)

    # -- stopping -----------------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        # Twice, each after an end of line: the first may join the rest of a line that was cut by discarding it.
        self._send(b"\n" + self._stop_lines)
        self._send(b"\n" + self._stop_lines)

    def _clear_faults(self) -> None:
        self._send(self._stop_lines)
        # The answer to a stop may still tell the old state, and a fault whose cause remains needs a moment to return.
        self.clock.sleep_until(self.clock.now_ns() + SETTLING_NS)
        self._poll_all()
        self._raise_on_fault()

    def _poll_all(self) -> None:
        """Ask all controllers for their state and wait for the answers."""
        self._pump()
        self._modes = [None] * len(self._addresses)
        self._ask_state()
        self._wait(self._all_answered, self._response_timeout, f"not all of controllers {self._addresses} answered")

    def _all_answered(self) -> bool:
        return all(mode is not None for mode in self._modes)

    def _health(self) -> dict[str, float | str]:
        health: dict[str, float | str] = {"damaged_lines": float(self.n_damaged + self._lines.n_dropped)}
        for joint, mode in zip(self._configuration.joints, self._modes, strict=True):
            health[f"{joint.name}: mode"] = "unknown" if mode is None else float(mode)
        return health


def _is_number(text: str, wanted: float) -> bool:
    try:
        return abs(float(text) - wanted) <= 1e-6 * max(1.0, abs(wanted))
    except ValueError:
        return False
