"""Dynamixel X servos as joints: goals for all in one packet, states of all in answer to one, every cycle."""

from collections.abc import Callable, Sequence
from math import tau

from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout, DriveFault
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

from ..bus_budget import BusBudget, serial_time
from ..link import SerialLink
from ..wrapping import CountUnwrapper, wrap_count
from .configuration import DynamixelConfiguration
from .control_table import (
    BUS_WATCHDOG,
    CONDITION,
    CURRENT_LIMIT,
    GOAL_CURRENT,
    GOAL_POSITION,
    GOAL_VELOCITY,
    HARDWARE_ERROR,
    LARGEST_POSITION,
    MODEL_NUMBER,
    MODES,
    OPERATING_MODE,
    POSITION_COUNT,
    PRESENT_POSITION,
    RETURN_DELAY,
    STATE,
    STATUS_RETURN_LEVEL,
    TORQUE_ENABLE,
    UNWANTED,
    VELOCITY_COUNT,
    VELOCITY_LIMIT,
    WATCHDOG_COUNT,
    Model,
    models,
)
from .goals import GoalWriter, compute_current_bound, stop_packets
from .packet import Instruction, StatusPacket, encode_packet, sync_read_packet
from .report import (
    FAULT_WATCHDOG,
    INDIRECT_ADDRESSES,
    MAPPING,
    REPORT_SIZE,
    STATUS_BYTES,
    UNBOUNDED,
    compute_fault,
    describe_fault,
    read_plain,
    read_report,
    report_request,
)
from .servo_line import ServoLine

__all__ = ["DynamixelAdapter"]

REBOOT_TIME = 0.5  # until a servo answers again [s]


class DynamixelAdapter(ServoLine):
    """Dynamixel X servos on one line.

    Args:
        configuration: Port and servos.
        open_link: Makes the link; pyserial as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    watchdog_faults = frozenset({FAULT_WATCHDOG})

    configuration_type = DynamixelConfiguration

    def __init__(
        self,
        configuration: DynamixelConfiguration,
        open_link: Callable[[], SerialLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, open_link, clock)
        n_joints = len(self._servos)
        self._goals = GoalWriter(self._servos)
        self._current_counts = [1.0] * n_joints
        self._data_addresses = [0] * n_joints
        self._turns = [CountUnwrapper() for _ in range(n_joints)]
        self._request, self._answer_bytes = sync_read_packet(*STATE, self._servos), STATE.size
        self._stop_packets = stop_packets(self._servos)
        self._guard = max(1, round(configuration.watchdog / WATCHDOG_COUNT))
        self._bounds = [0] * n_joints  # what the drive's own loop may draw, in counts of current
        self._most = [UNBOUNDED] * n_joints  # reported current beyond which the joints are stopped
        self._n_held_back = 0

    # -- receiving ------------------------------------------------------------------------------------------

    def _take_report(self, joint: int, packet: StatusPacket) -> bool:
        _, error, data = packet
        if len(data) == REPORT_SIZE:
            report = read_report(data)
        elif len(data) == STATE.size == self._answer_bytes:
            report = read_plain(data)
        else:
            return False
        current, velocity, position, temperature, energised, hardware_error, watchdog = report
        reported, fault = self._reported, 0
        if error or hardware_error or not energised or watchdog != self._guard or abs(current) > self._most[joint]:
            fault = compute_fault(report, error, self._guard if self._running else None, self._most[joint])
        reported.fault[joint] = fault
        if watchdog:
            reported.torque[joint] = current * self._goals.torque_counts[joint]
            reported.current[joint] = current * self._current_counts[joint]
            reported.velocity[joint] = velocity * VELOCITY_COUNT
            reported.position[joint] = self._turns[joint].unwrap(position) * POSITION_COUNT
            reported.temperature[joint] = float(temperature)
        if watchdog or fault:  # of a servo that has started again only the fault is true, but that must get through
            self._arrivals.mark(joint)
        return True

    # -- opening and configuring ------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._connect()
        # Until they are configured, the servos are asked for what can be read without writing anything.
        self._request, self._answer_bytes = sync_read_packet(*STATE, self._servos), STATE.size
        for turns in self._turns:
            turns.forget()
        joints = tuple(self._inspect(joint) for joint in range(len(self._servos)))
        rates = {mode: self._rate_in(mode) for mode in MODES}
        return Capabilities(joints, tuple(MODES), max(rates.values()), None, feed_forward=False, mode_rates=rates)

    def _inspect(self, joint: int) -> JointCapabilities:
        """What one servo can do.

        Raises:
            AdapterConfigurationError: It cannot control current, or is set to energise itself.
        """
        servo, named, goals = self._servos[joint], self._configuration.joints[joint], self._goals
        number = self._read_item(servo, MODEL_NUMBER)
        model = models().get(number, Model(f"model {number}"))
        if model.current_count is None:
            able = ", ".join(known.name for known in models().values() if known.current_count)
            raise AdapterConfigurationError(
                f"joint {named.name!r}: servo {servo} is a {model.name}, which cannot control current; able are {able}"
            )
        self._refuse_unwanted(servo, named.name)
        self._data_addresses[joint] = model.indirect_data
        goals.current_limits[joint] = self._read_item(servo, CURRENT_LIMIT)
        goals.velocity_limits[joint] = self._read_item(servo, VELOCITY_LIMIT)
        self._current_counts[joint] = model.current_count
        goals.torque_counts[joint] = count = model.current_count * (named.torque_constant or 1.0)
        return JointCapabilities(
            named.name,
            torque_unit="N·m" if named.torque_constant else "A",
            position_quantum=POSITION_COUNT,
            velocity_quantum=VELOCITY_COUNT,
            velocity_command_quantum=VELOCITY_COUNT,
            velocity_limit=goals.velocity_limits[joint] * VELOCITY_COUNT,
            torque_quantum=count,
            torque_limit=goals.current_limits[joint] * count,
        )

    def _find_energised(self) -> Sequence[bool | None]:
        return [bool(self._read_item(servo, TORQUE_ENABLE)) for servo in self._servos]

    def _refuse_unwanted(self, servo: int, name: str) -> None:
        for item, place, bit, what in UNWANTED:
            if self._read_bytes(servo, item)[place] & bit:
                raise AdapterConfigurationError(f"joint {name!r}: servo {servo} {what}, with the vendor's tool")

    def _rate_in(self, mode: CommandMode) -> float:
        """Highest rate in a mode: goals, the request for the reports, and all reports, one after the other [Hz].

        Nothing else is ever sent beside them: a second request would have to wait for the answers to the first. State
        and condition share one block therefore, for 4 bytes a servo and cycle.
        """
        baudrate, n_joints = self._configuration.serial.baudrate, len(self._servos)
        goals = self._goals.encode(JointCommand(n_joints), mode)
        request = report_request(self._servos, self._data_addresses)
        cycle = len(goals) + len(request) + n_joints * (REPORT_SIZE + STATUS_BYTES)
        return BusBudget([serial_time(cycle, baudrate)]).highest_rate

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._mode_in_use, self._running = mode, False
        for joint, servo in enumerate(self._servos):
            self._ensure_item(servo, STATUS_RETURN_LEVEL, 2)
            self._ensure_item(servo, TORQUE_ENABLE, 0)
            self._ensure_item(servo, RETURN_DELAY, 0)
            self._ensure_item(servo, OPERATING_MODE, MODES[mode])
            self._prepare_reports(servo)
            self._bound_torque(joint)
        self._request, self._answer_bytes = report_request(self._servos, self._data_addresses), REPORT_SIZE
        self._watchdog = Watchdog(self._guard * WATCHDOG_COUNT, confirmed=True, fed_by_reads=True)

    def _bound_torque(self, joint: int) -> None:
        """Keep the drive's own loop within the torque limit.

        Torque goals have passed the gate. In position mode goal current bounds the loop. The velocity loop ends in a
        voltage, and no manual says that goal current bounds it: a current reported beyond the limit is a fault there,
        which stops the joints. Goal current is set all the same; it does no harm where it is not used.

        Raises:
            AdapterConfigurationError: The limit is less than a step, beyond the servo's own, or refused.
        """
        self._bounds[joint], self._most[joint] = 0, UNBOUNDED
        if self._mode_in_use == "torque":
            return
        servo, most = self._servos[joint], self._goals.current_limits[joint]
        limit, gear = self._checked_options.limits[joint], self._checked_options.gears[joint]
        unit = "N·m" if self._configuration.joints[joint].torque_constant else "A"
        bound = compute_current_bound(limit.torque, unit, gear.gear_ratio, self._goals.torque_counts[joint])
        if bound > most:
            raise AdapterConfigurationError(
                f"servo {servo}: a torque limit of {bound} counts of current is beyond its current limit, {most}"
            )
        self._bounds[joint] = bound
        if self._mode_in_use == "velocity":
            self._most[joint] = bound
        try:
            self._write_confirmed(servo, GOAL_CURRENT, bound)
        except AdapterTimeout:
            raise
        except AdapterError as error:
            raise AdapterConfigurationError(f"servo {servo} cannot be bounded to its torque limit: {error}") from error

    def _prepare_reports(self, servo: int) -> None:
        """Watchdog, and the block that every cycle reads; both are forgotten when a servo starts again."""
        if self._read_bytes(servo, INDIRECT_ADDRESSES) != MAPPING:
            self._write_confirmed(servo, INDIRECT_ADDRESSES, int.from_bytes(MAPPING, "little"))
        self._arm_watchdog(servo)

    def _arm_watchdog(self, servo: int) -> None:
        self._write_item(servo, BUS_WATCHDOG, 0)  # also forgets that it has fired
        self._ensure_item(servo, BUS_WATCHDOG, self._guard)

    # -- moving -----------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        for servo in self._servos:
            self._raise_if_stopped()
            self._prepare(servo)
        for servo in self._servos:
            self._raise_if_stopped()
            self._write_item(servo, TORQUE_ENABLE, 1)
        for servo in self._servos:
            self._confirm(servo)
        for servo, bound in zip(self._servos, self._bounds, strict=True):
            self._raise_if_stopped()
            if bound:  # at zero until here: the drive's own loop begins without torque
                self._write_confirmed(servo, GOAL_CURRENT, bound)
        self._running = True

    def _prepare(self, servo: int) -> None:
        """De-energised, in its mode, guarded, and with goals that do nothing.

        The servo keeps its goals when its torque is switched on, and switching its mode makes goal current the whole
        current limit. The watchdog comes first: once it has fired, goals are refused until it is written 0.
        """
        error = self._read_item(servo, HARDWARE_ERROR)
        if error:
            told = describe_fault(error)
            raise DriveFault(f"servo {servo} reports hardware error {error:#x}, {told}: {self._how_to_clear}")
        self._ensure_item(servo, TORQUE_ENABLE, 0)
        self._ensure_item(servo, OPERATING_MODE, MODES[self._mode_in_use])
        self._prepare_reports(servo)
        self._write_confirmed(servo, GOAL_CURRENT, 0)
        self._write_confirmed(servo, GOAL_VELOCITY, 0)
        if self._mode_in_use == "position":
            here = self._read_item(servo, PRESENT_POSITION)
            if abs(wrap_count(here)) > LARGEST_POSITION:
                raise AdapterError(
                    f"servo {servo} stands {wrap_count(here) * POSITION_COUNT / tau:.0f} turns from its zero, and its "
                    f"position mode reaches 256: clear its turns, or switch it off and on"
                )
            self._write_confirmed(servo, GOAL_POSITION, here)

    def _confirm(self, servo: int) -> None:
        """Energised and guarded: the watchdog runs from the moment the torque is on.

        Raises:
            AdapterError: It is not so.
        """
        condition = self._read_bytes(servo, CONDITION)
        if condition[0] != 1:
            raise AdapterError(f"servo {servo} does not switch its torque on")
        if condition[-1] != self._guard:
            raise AdapterError(
                f"the bus watchdog of servo {servo} reads {condition[-1]} after enabling, not {self._guard}: "
                f"if it has fired (255), lengthen it or shorten the latency of the serial port"
            )

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        goals = self._goals.encode(command, mode)
        if self._is_taken():
            # A cycle came early, or an answer is missing. Goals would be destroyed by the answers, and destroy them;
            # those of the next cycle will find the wire silent, because the rate leaves time for a whole exchange.
            self._n_held_back += 1
            self._asked_ns = self._requested_ns
            return
        self._take_turn(len(goals) + self._exchange_bytes)
        self._send(goals + self._request)

    def _ask_state(self) -> None:
        if self._is_taken():
            self._asked_ns = self._requested_ns  # the state that comes is the one asked for then
            return
        self._take_turn(self._exchange_bytes)
        self._send(self._request)

    @property
    def _exchange_bytes(self) -> int:
        """Of the request and the answers to it [byte]."""
        return len(self._request) + len(self._servos) * (self._answer_bytes + STATUS_BYTES)

    # -- stopping -----------------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        self._silent_from_ns = self.clock.now_ns() + self._wire_ns(len(self._stop_packets))
        self._send(self._stop_packets)

    def _clear_faults(self) -> None:
        for servo in self._servos:
            if self._read_item(servo, HARDWARE_ERROR):
                self._reboot(servo)
        self._reported.fault[:] = [0] * len(self._servos)
        errors = [self._read_item(servo, HARDWARE_ERROR) for servo in self._servos]
        if any(errors):
            raise DriveFault(f"the servos report hardware errors after a reboot: {self.describe_faults(errors)}")
        for servo in self._servos:
            self._ensure_item(servo, STATUS_RETURN_LEVEL, 2)
            if self._answer_bytes == REPORT_SIZE:  # configured: what a restart has made them forget
                self._prepare_reports(servo)

    def _describe_fault(self, joint: int, code: int) -> str:
        return describe_fault(code)

    def _reboot(self, servo: int) -> None:
        """The only way out of a hardware error; the servo stays de-energised."""
        self._exchange(servo, encode_packet(servo, Instruction.REBOOT), 0, "a reboot")
        deadline = self.clock.now_ns() + round(4e9 * REBOOT_TIME)
        while True:
            self.clock.sleep_until(self.clock.now_ns() + 50_000_000)
            try:
                self._read_item(servo, HARDWARE_ERROR)
                return
            except AdapterTimeout:
                if self.clock.now_ns() > deadline:
                    raise

    def _health(self) -> dict[str, float | str]:
        return {"damaged_packets": float(self._buffer.n_damaged), "commands_held_back": float(self._n_held_back)}
