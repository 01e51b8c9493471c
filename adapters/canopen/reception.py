"""What CiA 402 drives send: answers to SDO, emergencies, heartbeats, and their state on every SYNC."""

from collections.abc import Callable
from functools import partial

from fricomp.errors import AdapterConfigurationError
from fricomp.joint import Clock

from ..can_adapter import CanAdapter
from ..link import CanFrame, CanLink
from .configuration import CanOpenConfiguration
from .drive import CONDITION, MOTION, CanOpenDrive
from .process_data import STATE_OBJECTS
from .service import ServiceChannel

SYNC = CanFrame(0x080)

# Frames that a node sends, by their identifier without the node number.
EMERGENCY, SDO_ANSWER, HEARTBEAT = 0x080, 0x580, 0x700


class CanOpenReceiver(CanAdapter):
    """The half of the adapter that takes in frames, by their identifiers; see `CanOpenAdapter`."""

    def __init__(
        self, configuration: CanOpenConfiguration, open_link: Callable[[], CanLink] | None, clock: Clock | None
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock, parts=len(STATE_OBJECTS))
        self._configuration = configuration
        self._drives = [self._make_drive(joint.id) for joint in configuration.joints]
        self._routes = self._make_routes()

    def _make_drive(self, node_id: int) -> CanOpenDrive:
        def send(identifier: int, data: bytes) -> None:
            self._send([CanFrame(identifier, data)])

        return CanOpenDrive(node_id, ServiceChannel(node_id, send, self._wait, self._response_timeout))

    def _make_routes(self) -> dict[int, Callable[[bytes], None]]:
        """What to do with the frames of each identifier, states aside."""
        routes: dict[int, Callable[[bytes], None]] = {}
        for joint, drive in enumerate(self._drives):
            node = drive.node_id
            routes[SDO_ANSWER + node] = drive.service.on_answer
            routes[EMERGENCY + node] = partial(self._take_emergency, joint)
            routes[HEARTBEAT + node] = partial(self._take_heartbeat, drive)
        return routes

    def _route_states(self) -> None:
        """Take states from now on: before, neither their scaling is known nor what the drives have mapped into them."""
        self._routes = self._make_routes()
        used = [SYNC.identifier, *self._routes]
        for joint, drive in enumerate(self._drives):
            command, (motion, condition) = drive.identifiers
            for identifier in (command, motion, condition):
                if identifier in used:
                    raise AdapterConfigurationError(
                        f"node {drive.node_id} has its process data on identifier {identifier:#05x}, which is in use: "
                        f"give it another one (1400 to 1403, 1800 to 1803)"
                    )
                used.append(identifier)
            self._routes[motion] = partial(self._take_motion, joint)
            self._routes[condition] = partial(self._take_condition, joint)

    def _on_frame(self, frame: CanFrame) -> None:
        route = None if frame.extended else self._routes.get(frame.identifier)
        if route is not None:
            route(frame.data)

    def _take_heartbeat(self, drive: CanOpenDrive, data: bytes) -> None:
        drive.take_heartbeat(data, self.clock.now_ns())

    def _take_emergency(self, joint: int, data: bytes) -> None:
        """An error counts as a state: a node that has left operational sends no other (1029)."""
        drive = self._drives[joint]
        drive.take_emergency(data)
        if drive.emergency:
            self._reported.fault[joint] = drive.emergency
            self._arrivals.mark(2 * joint)
            self._arrivals.mark(2 * joint + 1)
            self._taken_ns = -1  # whatever was asked for, and taken already

    def _take_motion(self, joint: int, data: bytes) -> None:
        if len(data) != MOTION.size:
            self.n_damaged += 1
            return
        drive, reported = self._drives[joint], self._reported
        drive.take_motion(data)
        reported.position[joint] = drive.position_count * drive.scaling.position
        reported.torque[joint] = drive.torque_count * drive.scaling.torque
        self._arrivals.mark(2 * joint)

    def _take_condition(self, joint: int, data: bytes) -> None:
        if len(data) != CONDITION.size:
            self.n_damaged += 1
            return
        drive, reported = self._drives[joint], self._reported
        drive.take_condition(data)
        reported.velocity[joint] = drive.velocity_count * drive.scaling.velocity
        reported.fault[joint] = drive.find_fault(self._running)
        self._arrivals.mark(2 * joint + 1)
