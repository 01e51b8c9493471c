"""CiA 402 drives as joints: SDO to configure, then PDOs pumped from the control thread, one SYNC a cycle."""

from collections.abc import Callable, Sequence
from contextlib import suppress

from fricomp.errors import (
    AdapterConnectionError,
    AdapterError,
    AdapterTimeout,
    DriveFault,
)
from fricomp.joint import Capabilities, Clock, CommandMode, JointCommand, Watchdog

from ..link import CanFrame, CanLink
from . import objects
from .capability import declare
from .clearing import clear_by_service
from .configuration import CanOpenConfiguration
from .drive import MODE_NUMBERS, OPERATIONAL, CanOpenDrive
from .fault import describe_fault
from .process_data import map_process_data
from .reception import HEARTBEAT, SYNC, CanOpenReceiver
from .scaling import read_scaling
from .set_up import clear_targets, find_modes, restart_watchdog, set_mode, set_period, set_watchdog
from .state_machine import CLEAR_FAULT, DISABLE_VOLTAGE, ENABLE_STEPS, ENERGISED, DriveState
from .torque_limit import find_most_torque, restore_torque_limits, set_torque_limit

__all__ = ["CanOpenAdapter"]

NMT_START, NMT_PRE_OPERATIONAL = 0x01, 0x80
STOPPED = 4  # state of a node in its heartbeat

HEARTBEATS_MISSED = 3
STEP = 0.002  # between the commands that lead a drive through its states [s]


class CanOpenAdapter(CanOpenReceiver):
    """CiA 402 drives on one CAN bus.

    Args:
        configuration: Bus and drives.
        open_link: Makes the link; python-can as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    watchdog_faults = frozenset({0x8130})  # life guard or heartbeat error [cia301]

    configuration_type = CanOpenConfiguration

    def __init__(
        self,
        configuration: CanOpenConfiguration,
        open_link: Callable[[], CanLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, open_link, clock)
        self._period = STEP
        self._configured = False  # to the end, and nothing has come between since
        self._known = False  # whether mode and period in use were ever configured to the end
        self._next_beat_ns = 0

    # -- opening ------------------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._configured = self._known = False
        self._routes = self._make_routes()
        for drive in self._drives:
            drive.max_torque_found = None
            drive.turns.forget()
        self._connect()
        modes = set(MODE_NUMBERS)
        torque: list[float] = []
        for number, (joint, drive) in enumerate(zip(self._configuration.joints, self._drives, strict=True)):
            try:
                self._wake(drive)
                modes &= find_modes(drive)
                drive.scaling = read_scaling(drive.service, joint.counts_per_revolution, joint.velocity_count)
                torque.append(find_most_torque(drive, self._torques_at_drives()[number]))
            except AdapterError as error:
                raise type(error)(f"joint {joint.name!r}: {error}") from error
        return declare(self._configuration, self._drives, modes, torque)

    def _wake(self, drive: CanOpenDrive) -> None:
        """A node that NMT has stopped answers no SDO: it is led to pre-operational if its user wants to take over.

        Raises:
            AdapterError: It is stopped, and nobody has said so.
        """
        try:
            drive.service.read(objects.DEVICE_TYPE)
        except AdapterTimeout as error:
            if drive.nmt_state != STOPPED:
                raise
            if not self._may_take_over:
                hint = self._command_line("clear", "--take-over")
                raise AdapterError(
                    f"node {drive.node_id} is stopped by NMT and answers nothing: {hint} leads it to pre-operational"
                ) from error
            self._send([_nmt(NMT_PRE_OPERATIONAL, drive)])

    def _find_energised(self) -> Sequence[bool | None]:
        for drive in self._drives:
            drive.take_statusword(drive.service.read(objects.STATUSWORD))
        return [drive.state in ENERGISED for drive in self._drives]

    def _take_over(self) -> None:
        """By SDO alone: what stands in the process data of whoever has set up these nodes is not known."""
        for drive in self._drives:
            drive.service.try_write(objects.TARGET_TORQUE, 0)
            drive.service.try_write(objects.TORQUE_OFFSET, 0)
            drive.service.write(objects.CONTROLWORD, DISABLE_VOLTAGE)

    # -- configuring --------------------------------------------------------------------------------------

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._configured = self._running = False
        confirmed = True
        for number, joint in enumerate(self._configuration.joints):
            try:
                confirmed = self._configure_drive(number, mode, period) and confirmed
            except AdapterError as error:
                raise type(error)(f"joint {joint.name!r}: {error}") from error
        self._watchdog = Watchdog(self._configuration.watchdog, confirmed)
        self._route_states()
        self._pump()  # a heartbeat from before the start would tell an old state
        for drive in self._drives:
            drive.use_mode(mode)
            drive.emergency, drive.nmt_state, drive.heard_ns = 0, None, None
            self._send([_nmt(NMT_START, drive)])
        self._arrivals.clear()
        self._send([SYNC])
        self._wait(self._arrivals.take, self._response_timeout, "not all drives answered SYNC with their state")
        self._mode_in_use, self._period = mode, period
        self._configured = self._known = True

    def _configure_drive(self, number: int, mode: CommandMode, period: float) -> bool:
        """Tell one drive, in pre-operational, all it has to know; whether its watchdog is confirmed."""
        drive = self._drives[number]
        self._send([_nmt(NMT_PRE_OPERATIONAL, drive)])
        if drive.restarted:
            drive.turns.forget()
        drive.restarted = False
        drive.identifiers = map_process_data(drive.service, drive.node_id, mode)
        clear_targets(drive, mode)
        set_torque_limit(drive, self._torques_at_drives()[number], mode)
        set_mode(drive, mode, self._wait_for_answer)
        set_period(drive, period)
        return set_watchdog(drive, self._configuration)

    def _wait_for_answer(self, condition: Callable[[], bool]) -> None:
        self._wait(condition, self._response_timeout, "no such answer")

    # -- moving -------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        if not self._configured:  # clearing faults did not end
            raise AdapterError("the drives were not configured to the end: configure() them again")
        self._pump()  # what has come while nobody read
        for drive in self._drives:
            if drive.restarted:
                raise DriveFault(f"node {drive.node_id} has restarted: clear_faults() configures it again")
            drive.heard_ns = self.clock.now_ns()  # silence while nobody listened is none of the drive's
        self._next_beat_ns = 0  # the first step towards torque carries a heartbeat: from there on the drive watches us
        self._lead(self._enabling_word, self._all_enabled, "the drives did not reach operation enabled")
        for drive in self._drives:
            if drive.mode_display != MODE_NUMBERS[self._mode_in_use]:
                raise AdapterError(f"node {drive.node_id} is in mode {drive.mode_display}, not in {self._mode_in_use}")
            if fault := drive.find_fault(running=True):
                raise DriveFault(f"node {drive.node_id} reports {_shown(fault)}: {self._how_to_clear}")
        self._running = True

    def _enabling_word(self, drive: CanOpenDrive, step: int) -> int:
        if drive.emergency:  # would stop the joints in the first cycle: refused while nothing is energised yet
            raise DriveFault(f"node {drive.node_id} reports emergency {_shown(drive.emergency)}: {self._how_to_clear}")
        if drive.state not in ENABLE_STEPS:
            raise DriveFault(
                f"node {drive.node_id} is in state {drive.state.value!r}, error {_shown(drive.error_code)}: "
                f"{self._how_to_clear}"
            )
        self._raise_if_stopped()
        return ENABLE_STEPS[drive.state]

    def _all_enabled(self) -> bool:
        return all(drive.state is DriveState.OPERATION_ENABLED for drive in self._drives)

    def _lead(self, word: Callable[[CanOpenDrive, int], int], arrived: Callable[[], bool], complaint: str) -> None:
        """Command controlwords at rest, cycle by cycle, until the drives say that they have arrived."""
        deadline = self.clock.now_ns() + round(2e9 * self._response_timeout)
        step, answered = 0, False
        self._arrivals.clear()  # states from before do not count
        while True:
            self._send_cycle([drive.resting_command(word(drive, step)) for drive in self._drives])
            self.clock.sleep_until(self.clock.now_ns() + round(max(self._period, STEP) * 1e9))
            self._pump()
            answered = answered or self._arrivals.take()
            if answered and arrived():
                return
            step += 1
            if self.clock.now_ns() >= deadline:
                if not answered:
                    raise AdapterConnectionError("not all drives answer SYNC with their state")
                states = ", ".join(f"node {drive.node_id}: {drive.state.value}" for drive in self._drives)
                raise AdapterTimeout(f"{complaint} ({states})")

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        torque, velocity, position = command.torque, command.velocity, command.position
        word = ENABLE_STEPS[DriveState.OPERATION_ENABLED]
        self._send_cycle(
            [
                drive.command(word, torque[joint], velocity[joint], position[joint])
                for joint, drive in enumerate(self._drives)
            ]
        )

    def _send_cycle(self, frames: list[CanFrame]) -> None:
        """Commands, then the SYNC on which all drives take them at once, and our heartbeat when it is due."""
        frames.append(SYNC)
        now = self.clock.now_ns()
        if now >= self._next_beat_ns:
            self._next_beat_ns = now + round(self._configuration.beat_period * 1e9)
            frames.append(CanFrame(HEARTBEAT + self._configuration.master_id, bytes((OPERATIONAL,))))
        self._send(frames)

    def _ask_state(self) -> None:
        self._send([SYNC])

    def _check_link(self, now_ns: int) -> None:
        if not self._running:
            return
        longest = HEARTBEATS_MISSED * self._configuration.heartbeat * 1e9
        for drive in self._drives:
            if drive.heard_ns is not None and now_ns - drive.heard_ns > longest:
                raise AdapterConnectionError(
                    f"node {drive.node_id} has not been heard for {(now_ns - drive.heard_ns) * 1e-9:.2f} s"
                )
            if drive.restarted:
                raise DriveFault(f"node {drive.node_id} has restarted")

    def _describe_fault(self, joint: int, code: int) -> str:
        return describe_fault(code)

    # -- stopping -----------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        self._send([*(drive.resting_command(DISABLE_VOLTAGE) for drive in self._drives), SYNC])
        self._send([drive.disable_frame() for drive in self._drives])

    def _clear_faults(self) -> None:
        self._pump()
        if not self._known:
            for drive in self._drives:  # the nodes take no process data of ours: `fricomp adapter clear`
                clear_by_service(drive, self._wait_for_answer)
            return
        if not self._configured or any(drive.restarted for drive in self._drives):
            self._configure(self._mode_in_use, self._period)
        for drive in self._drives:
            drive.nmt_state = None
            self._send([_nmt(NMT_START, drive)])  # a node that misses our heartbeat leaves operational (1029) [cia301]
        try:
            self._lead(_clearing_word, self._all_cleared, "the fault stays")
        except AdapterTimeout as error:
            codes = ", ".join(f"node {d.node_id}: {_shown(d.error_code or d.emergency)}" for d in self._drives)
            raise DriveFault(f"{error}; error codes {codes}") from error
        for drive in self._drives:
            drive.emergency = 0
        self._send([*(drive.resting_command(DISABLE_VOLTAGE) for drive in self._drives), SYNC])
        self._restart_watchdogs()

    def _end_motion(self) -> None:
        """A drive that went on watching us would miss a heartbeat, complain, and leave operational (1029)."""
        self._restart_watchdogs()

    def _restart_watchdogs(self) -> None:
        """Let no drive miss a heartbeat before enabling sends the next one.

        None goes out at rest, because nobody has to read or write there: a program that asks its user, or computes,
        between clearing and enabling would be late, and the drives would be right to complain. So they are told to
        watch anew, which begins with the first heartbeat of enabling. One that complains all the same is not enabled.

        Raises:
            AdapterError: A drive that kept its watchdog before does not keep it now; enabling is refused.
        """
        self._configured = False
        confirmed = [restart_watchdog(drive, self._configuration) for drive in self._drives]
        promised = self.capabilities.watchdog  # by which enabling is allowed
        if promised is not None and promised.confirmed and not all(confirmed):
            raise AdapterError("the drives no longer keep the watchdog (1016): configure() them again")
        self._configured = True

    def _all_cleared(self) -> bool:
        return all(drive.find_fault(running=False) == 0 for drive in self._drives)

    def _close(self) -> None:
        try:
            if not self._stop_owed:  # a drive that may still be energised keeps the lower limit
                self._restore_torque_limits()
        finally:
            super()._close()

    def _restore_torque_limits(self) -> None:
        """Best effort: what stays behind otherwise is the lower limit, which the next run keeps to or refuses."""
        if all(drive.max_torque_found is None for drive in self._drives):
            return
        with suppress(AdapterError):
            self.clock.sleep_until(self.clock.now_ns() + round(STEP * 1e9))
            self._pump()  # the answer to the stop, which nobody has waited for
            restore_torque_limits(self._drives)

    def _health(self) -> dict[str, float | str]:
        health: dict[str, float | str] = {"damaged_frames": float(self.n_damaged)}
        for joint, drive in zip(self._configuration.joints, self._drives, strict=True):
            health[f"{joint.name}: state"] = drive.state.value
            health[f"{joint.name}: error"] = f"{drive.error_code or drive.emergency:#06x}"
        return health


def _clearing_word(drive: CanOpenDrive, step: int) -> int:
    """A rising edge of the reset bit every other cycle, for drives in fault only."""
    return CLEAR_FAULT if drive.state is DriveState.FAULT and step % 2 else DISABLE_VOLTAGE


def _nmt(command: int, drive: CanOpenDrive) -> CanFrame:
    return CanFrame(0x000, bytes((command, drive.node_id)))


def _shown(code: int) -> str:
    words = describe_fault(code)
    return f"{code:#06x} ({words})" if words else f"{code:#06x}"
