"""The half that all adapters over a link share: holding the link, pumping it, asking for states and waiting."""

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, ClassVar, Generic, Protocol, Self, TypeVar, final

from fricomp.errors import AdapterConfigurationError, AdapterConnectionError, AdapterTimeout, DriveFault
from fricomp.joint import Clock, CommandMode, JointFeedback, Watchdog

from .adapter import JointAdapter
from .configuration import AdapterConfiguration, JointConfiguration, convert, options_of
from .holding import POLL_INTERVAL_NS

__all__ = ["LinkAdapter"]

REST_PERIOD_NS = 5_000_000
"""How often drives at rest, to which nothing is written, are asked for their state [ns]."""
HELD_UP_NS = 5_000_000
"""How long a request may take out of this process [ns]: as often as motion is looked at by the gate."""


class AnyLink(Protocol):
    """What CAN buses and serial ports have in common."""

    def discard_output(self) -> None:
        """Drop what still waits to be sent."""

    def close(self) -> None:
        """Let go."""


Link = TypeVar("Link", bound=AnyLink)
Configuration = TypeVar("Configuration", bound=AdapterConfiguration)


class Arrivals:
    """Keeps the joints that are still to report: the state is new once every part of it, from every joint, has come
    again, so that one silent drive among many makes it stale.

    Args:
        n_parts: Number of joints, times the messages that make up the state of one.

    Attributes:
        mark: To be called with the number of a part that has come.
    """

    def __init__(self, n_parts: int) -> None:
        self._n_parts = n_parts
        self._arrived: set[int] = set()
        self.mark: Callable[[int], None] = self._arrived.add  # without a call of ours around it, for every state

    def take(self) -> bool:
        """Whether all have reported since this was last true; begins anew then."""
        if len(self._arrived) < self._n_parts:
            return False
        self._arrived.clear()
        return True

    def clear(self) -> None:
        """Begin anew."""
        self._arrived.clear()


class LinkAdapter(JointAdapter, Generic[Configuration, Link]):
    """N drives behind one link. Received in the control thread only; any thread may send.

    Args:
        configuration: Of bus and adapter.
        joints: In its order.
        open_link: Makes the link, called by `open`; as configured unless given.
        clock: Real time unless a simulation brings its own.
        parts: Messages that make up the state of one joint.

    Attributes:
        n_damaged: Messages that were damaged, or from nobody on the bus that is known.

    Drivers keep in `_watchdog` what they read back of it, in `_mode_in_use` the mode that they have configured, and in
    `_running` whether the drives have been energised to the end, so that one that is not is a fault.

    Raises:
        AdapterConfigurationError: A limit or a transmission is out of its domain.
    """

    configuration_type: ClassVar[type[AdapterConfiguration]]
    """What the content of a configuration file is converted to."""

    def __init__(
        self,
        configuration: Configuration,
        joints: Sequence[JointConfiguration],
        open_link: Callable[[], Link] | None,
        clock: Clock | None,
        *,
        parts: int = 1,
    ) -> None:
        super().__init__(options_of(configuration, joints), clock)
        self._response_timeout = configuration.response_timeout
        self._names = tuple(joint.name for joint in joints)
        self._open_link = open_link or partial(self._link_of, configuration)
        self._link: Link | None = None
        self._arrivals = Arrivals(parts * len(joints))
        self._reported = JointFeedback(len(joints))
        self._taken_ns = -1
        self._was_held_up = False
        self._watchdog: Watchdog | None = None
        self._mode_in_use: CommandMode = "torque"
        self._running = False
        self.n_damaged = 0

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make the adapter from what stands in the configuration file."""
        make: Any = cls  # the arguments of a protocol's adapter are fewer
        made: Self = make(convert(configuration, cls.configuration_type))
        return made

    @staticmethod
    @abstractmethod
    def _link_of(configuration: Configuration) -> Link:
        """Open the link that is configured."""

    @abstractmethod
    def _pump(self) -> None:
        """Take in everything that has come: mark `_arrivals`, fill `_reported`; ignore what is foreign or damaged."""

    @abstractmethod
    def _ask_state(self) -> None:
        """Ask all drives for their state, as every write does."""

    def _check_link(self, now_ns: int) -> None:
        """Look at what the link itself tells after it was pumped, such as heartbeats that stay away.

        Raises:
            AdapterError: The link or a drive behind it is lost.
        """

    @final
    def _read_into(self, feedback: JointFeedback) -> bool:
        now = self.clock.now_ns()
        self._pump()
        self._check_link(now)
        fresh = self._take_reported(feedback)  # before the next request: it answers the one before
        if not self.enabled and now - self._asked_ns > REST_PERIOD_NS:
            self._asked_ns = now
            self._ask_state()
        return fresh

    def _confirmed_watchdog(self) -> Watchdog | None:
        return self._watchdog

    @final
    def _raise_on_fault(self) -> None:
        """Refuse to go on with drives that have reported a fault.

        Raises:
            DriveFault: One has.
        """
        if any(self._reported.fault):
            told = self.describe_faults(self._reported.fault)
            raise DriveFault(f"the drives report faults ({told}): {self._how_to_clear}")

    @final
    def _joint_names(self) -> Sequence[str]:
        return self._names

    @final
    def _connect(self) -> None:
        self._watchdog, self._running = None, False
        self._link = self._open_link()
        self._pump()  # what an earlier owner of the bus left behind

    @property
    @final
    def _opened_link(self) -> Link:
        if self._link is None:
            raise AdapterConnectionError("the bus is not open")
        return self._link

    @final
    def _forget_states(self) -> None:
        self._pump()
        self._arrivals.clear()

    @final
    def _await_states(self, complaint: str) -> None:
        """Ask all drives for their state, and wait until each has told it anew.

        Raises:
            AdapterTimeout: Not all have within the response timeout.
        """
        self._forget_states()
        self._ask_state()
        self._wait(self._arrivals.take, self._response_timeout, complaint)

    @final
    def _check_delay(self, stale_after: float) -> None:
        """Ask once while nothing else is under way: later an answer cannot be told from one to an earlier request."""
        self._pump()
        asked = self.clock.now_ns()
        self._await_states("not all joints answered with their state")
        delay = (self.clock.now_ns() - asked) * 1e-9
        if delay > stale_after:
            raise AdapterConfigurationError(
                f"answers take {1e3 * delay:.1f} ms on this bus, and data are stale after {1e3 * stale_after:g} ms: "
                f"find what holds them up, or raise stale_after, knowing that the joints are controlled that late"
            )

    @final
    def _ask_faults(self) -> Sequence[int]:
        with suppress(AdapterTimeout):  # one that has fallen silent may have told it by itself, as CANopen's EMCY
            self._await_states("not all joints answered with their state")
        return list(self._reported.fault)

    @final
    def _discard_output(self) -> None:
        if self._link is not None:
            self._link.discard_output()

    @final
    def _wait(self, condition: Callable[[], bool], seconds: float, complaint: str) -> None:
        """Pump until `condition` holds.

        Raises:
            AdapterTimeout: It does not within `seconds` of the adapter's clock.
        """
        deadline = self.clock.now_ns() + round(seconds * 1e9)
        while True:
            self._pump()
            if condition():
                return
            now = self.clock.now_ns()
            if now >= deadline:
                raise AdapterTimeout(f"{complaint} within {seconds:g} s")
            self.clock.sleep_until(now + POLL_INTERVAL_NS)

    @final
    def _take_reported(self, feedback: JointFeedback) -> bool:
        """Hand over the drives' state if all have reported anew; the lists themselves, which nobody else changes.

        It is as old as the request it answers: a frame does not say how long it has waited here to be read. What
        comes twice for one request is no new state.
        """
        if not self._arrivals.take() or self._taken_ns == self._asked_ns:
            return False
        self._taken_ns = self._asked_ns
        if self._is_untimed():
            return False
        source = self._reported
        feedback.time_ns = self._asked_ns
        feedback.position, feedback.velocity = source.position, source.velocity
        feedback.torque, feedback.current = source.torque, source.current
        feedback.temperature, feedback.fault = source.temperature, source.fault
        return True

    def _is_untimed(self) -> bool:
        """Whether nobody knows how old the state is, because its request was held up in a process that was halted.

        Taken for as old as the request, the joint would seem to have jumped. Never twice in a row: on a bus that always
        is as slow, that is the age that its states have.
        """
        self._was_held_up = self._sending_ns > HELD_UP_NS and not self._was_held_up
        return self._was_held_up

    def _close(self) -> None:
        link, self._link = self._link, None
        if link is not None:
            link.close()
