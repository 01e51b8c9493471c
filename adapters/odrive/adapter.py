"""ODrives as joints: a set-point and requests for the state every cycle, all in passthrough."""

from collections.abc import Callable, Sequence
from functools import partial
from math import tau

from fricomp.errors import AdapterError
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

from ..bus_budget import BusBudget, can_frame_bits
from ..link import CanFrame, CanLink
from .codec import (
    AxisState,
    Command,
    Heartbeat,
    axis_state_frame,
    controller_mode_frame,
    decode_heartbeat,
    decode_pair,
    decode_temperature,
    input_frame,
    plain_frame,
    request_frame,
)
from .configuration import OdriveConfiguration
from .fault import FAULT_NOT_ENABLED, FAULT_OF_PART, describe_fault
from .parameter import HOW_TO_BOUND, ParameterAdapter

__all__ = ["OdriveAdapter"]

FEEDING_PERIOD_NS = 5_000_000
SLOW_PERIOD_NS = 100_000_000  # temperatures
SLOWEST_HEARTBEAT = 0.5
ONLY_IN_06 = (Command.TEMPERATURE, Command.ENDPOINT_ANSWER)  # 0.5 has other reports at these numbers


class OdriveAdapter(ParameterAdapter):
    """ODrives on one CAN bus.

    Args:
        configuration: Bus and axes.
        open_link: Makes the link; python-can as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    configuration_type = OdriveConfiguration

    def __init__(
        self,
        configuration: OdriveConfiguration,
        open_link: Callable[[], CanLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, open_link, clock)
        self.watchdog_faults = frozenset({0x0000_0800 if configuration.minor == 5 else 0x0100_0000})
        self._effort = Command.TORQUES if configuration.minor == 6 else Command.CURRENT
        self._requests = [
            request_frame(node, command)
            for node in self._nodes
            for command in (Command.ENCODER_ESTIMATES, self._effort)
        ]
        self._heartbeats: list[Heartbeat | None] = [None] * len(self._nodes)
        self._awaited: set[int] = set()  # parts of the state that were asked for and have not come
        self._slow_ns, self._fed_ns = -SLOW_PERIOD_NS, 0
        self._rest: list[CanFrame] = []
        self._routes = self._make_routes()

    # -- receiving ------------------------------------------------------------------------------------------

    def _make_routes(self) -> dict[int, Callable[[bytes], None]]:
        routes: dict[int, Callable[[bytes], None]] = {}
        for joint, node in enumerate(self._nodes):
            for command, route in (
                (Command.HEARTBEAT, self._take_heartbeat),
                (Command.ENCODER_ESTIMATES, self._take_estimates),
                (self._effort, self._take_effort),
                (Command.TEMPERATURE, self._take_temperature),
                (Command.ENDPOINT_ANSWER, self._take_answer),
                (Command.VERSION, self._take_answer),
            ):
                if self._configuration.minor == 6 or command not in ONLY_IN_06:
                    routes[node << 5 | command] = partial(route, joint)
        return routes

    def _on_frame(self, frame: CanFrame) -> None:
        route = None if frame.extended else self._routes.get(frame.identifier)
        if route is not None:
            route(frame.data)

    def _take_heartbeat(self, joint: int, data: bytes) -> None:
        heartbeat = decode_heartbeat(data, self._configuration.minor)
        if heartbeat is None:
            self.n_damaged += 1
            return
        self._heartbeats[joint] = heartbeat
        self._reported.fault[joint] = self._find_fault(heartbeat)

    def _find_fault(self, heartbeat: Heartbeat) -> int:
        if heartbeat.error:
            return heartbeat.error
        if heartbeat.flags:
            return FAULT_OF_PART
        return FAULT_NOT_ENABLED if self._running and heartbeat.state != AxisState.CLOSED_LOOP else 0

    def _take_estimates(self, joint: int, data: bytes) -> None:
        pair = self._awaited_pair(2 * joint, data)
        if pair is None:
            return
        self._reported.position[joint], self._reported.velocity[joint] = pair[0] * tau, pair[1] * tau
        self._arrivals.mark(2 * joint)

    def _awaited_pair(self, part: int, data: bytes) -> tuple[float, float] | None:
        """The floats of an answer; None of a report that nobody has asked for: it is of another time than the rest."""
        pair = decode_pair(data)
        if pair is None:
            self.n_damaged += 1
        elif part in self._awaited:
            self._awaited.remove(part)
            return pair
        return None

    def _take_effort(self, joint: int, data: bytes) -> None:
        pair = self._awaited_pair(2 * joint + 1, data)
        if pair is None:
            return
        if self._configuration.minor == 6:
            self._reported.torque[joint] = pair[1]
        else:
            self._reported.current[joint] = pair[1]
            self._reported.torque[joint] = pair[1] * (self._configuration.joints[joint].torque_constant or 0.0)
        self._arrivals.mark(2 * joint + 1)

    def _take_temperature(self, joint: int, data: bytes) -> None:
        hottest = decode_temperature(data)
        if hottest is None:
            self.n_damaged += 1
            return
        self._reported.temperature[joint] = hottest

    # -- opening and configuring ------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._heartbeats = [None] * len(self._nodes)
        self._connect()
        self._check_version()
        self._poll_all()
        joints = tuple(map(self._declare, range(len(self._nodes))))
        return Capabilities(joints, self._modes(), self._highest_rate(), None)

    def _find_energised(self) -> Sequence[bool | None]:
        self._await_heartbeats()
        limp = (AxisState.UNDEFINED, AxisState.IDLE)
        return [heartbeat is not None and heartbeat.state not in limp for heartbeat in self._heartbeats]

    def _declare(self, joint: int) -> JointCapabilities:
        return JointCapabilities(
            self._configuration.joints[joint].name,
            torque_limit=self._own_torque_limit(joint),
            reports_temperature=self._configuration.minor == 6,
        )

    def _poll_all(self) -> None:
        self._await_states(f"not all of nodes {self._nodes} answered with their estimates")

    def _modes(self) -> tuple[CommandMode, ...]:
        # Set_Limits of CANSimple is no substitute: it bounds the current, and what it has set cannot be asked for.
        return ("torque", "velocity", "position") if self._is_bounded else ("torque",)

    def _highest_rate(self) -> float:
        bitrate, n_joints = self._configuration.bus.bitrate, len(self._nodes)
        bits = can_frame_bits(8) + 2 * (can_frame_bits(0) + can_frame_bits(8))
        slow = n_joints * (can_frame_bits(0) + can_frame_bits(8)) * 1e9 / SLOW_PERIOD_NS
        heartbeats = n_joints * can_frame_bits(8) * 10.0
        return BusBudget([bits / bitrate] * n_joints, (slow + heartbeats) / bitrate).highest_rate

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._mode_in_use, self._running = mode, False
        confirmed = bool(self._endpoints)
        for joint, node in enumerate(self._nodes):
            self._bound_torque(joint, mode)
            self._send([controller_mode_frame(node, mode)])
            self._check_mode(joint, mode)
            confirmed = bool(self._endpoints) and self._set_watchdog(joint) and confirmed
        self._watchdog = Watchdog(self._configuration.watchdog, confirmed) if self._endpoints else None
        self._await_heartbeats()

    def _await_heartbeats(self) -> None:
        self._pump()  # those that lie here are from before
        self._heartbeats = [None] * len(self._nodes)
        self._wait(self._all_heard, SLOWEST_HEARTBEAT, f"not all of nodes {self._nodes} sent a heartbeat")

    def _all_heard(self) -> bool:
        return all(heartbeat is not None for heartbeat in self._heartbeats)

    # -- moving -----------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        mode = self._mode_in_use
        self._raise_on_fault()
        for joint, node in enumerate(self._nodes):  # once more: it may have been power cycled since it was configured
            self._bound_torque(joint, mode)
            kept = self._watchdog is None or self._set_watchdog(joint)
            if self._watchdog is not None and self._watchdog.confirmed and not kept:
                raise AdapterError(f"node {node} does not keep its watchdog any more: configure() it again")
        self._raise_if_stopped()
        self._poll_all()  # where the joints are now is where they will be held
        self._rest = [self._rest_frame(joint) for joint in range(len(self._nodes))]
        self._heartbeats = [None] * len(self._nodes)
        for node, rest in zip(self._nodes, self._rest, strict=True):
            state = axis_state_frame(node, AxisState.CLOSED_LOOP)
            self._send([controller_mode_frame(node, mode), rest, state, rest])
        self._fed_ns = self.clock.now_ns()
        self._wait(self._all_in_closed_loop, SLOWEST_HEARTBEAT, "not all axes reached closed loop control")
        self._running = True

    def _all_in_closed_loop(self) -> bool:
        self._raise_if_stopped()
        self._raise_on_fault()
        if self.clock.now_ns() - self._fed_ns > FEEDING_PERIOD_NS:  # heartbeats are slower than a watchdog may be
            self._fed_ns = self.clock.now_ns()
            self._send(self._rest)
        states = [heartbeat.state if heartbeat else None for heartbeat in self._heartbeats]
        return all(state == AxisState.CLOSED_LOOP for state in states)

    def _rest_frame(self, joint: int) -> CanFrame:
        mode = self._mode_in_use
        position = self._reported.position[joint] if mode == "position" else 0.0
        return input_frame(self._nodes[joint], mode, 0.0, 0.0, position)

    def _describe_fault(self, joint: int, code: int) -> str:
        return describe_fault(code, self._configuration.minor)

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        torque, velocity, position = command.torque, command.velocity, command.position
        frames = [
            input_frame(node, mode, torque[joint], velocity[joint], position[joint])
            for joint, node in enumerate(self._nodes)
        ]
        self._send(frames + self._state_requests())

    def _ask_state(self) -> None:
        self._send(self._state_requests())

    def _state_requests(self) -> list[CanFrame]:
        """What asks all axes for their state; for their temperatures only now and then."""
        now = self.clock.now_ns()
        self._awaited.update(range(2 * len(self._nodes)))
        if self._configuration.minor == 5 or now - self._slow_ns < SLOW_PERIOD_NS:  # 0.5 does not tell temperatures
            return self._requests
        self._slow_ns = now
        return self._requests + [request_frame(node, Command.TEMPERATURE) for node in self._nodes]

    # -- stopping -----------------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        self._send([input_frame(node, "torque", 0.0, 0.0, 0.0) for node in self._nodes])
        self._send([axis_state_frame(node, AxisState.IDLE) for node in self._nodes])

    def _clear_faults(self) -> None:
        data = b"\0" if self._configuration.minor == 6 else b""
        self._send([plain_frame(node, Command.CLEAR_ERRORS, data) for node in self._nodes])
        self._pump()
        self._reported.fault[:] = [0] * len(self._nodes)
        self._await_heartbeats()
        self._raise_on_fault()

    def _health(self) -> dict[str, float | str]:
        health: dict[str, float | str] = {"damaged_frames": float(self.n_damaged)}
        if not self._is_bounded:
            health["velocity and position mode"] = HOW_TO_BOUND
        for joint, heartbeat in zip(self._configuration.joints, self._heartbeats, strict=True):
            if heartbeat is not None:
                health[f"{joint.name}: state"] = float(heartbeat.state)
                health[f"{joint.name}: error"] = f"{heartbeat.error:#x}"
        return health
