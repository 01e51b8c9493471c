"""What a test bench for an adapter offers: the adapter, its drives, and ways to break things."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from fricomp.control import SafetyGate
from fricomp.joint import Capabilities, CommandMode, JointCommand, JointFeedback
from fricomp.testing.clock import VirtualClock
from fricomp.testing.faulty_link import FaultyLink


class AdapterUnderTest(Protocol):
    """The public face of `fricomp.adapters.JointAdapter`."""

    @property
    def capabilities(self) -> Capabilities:
        """What the drives offer."""

    @property
    def gate(self) -> SafetyGate:
        """The safety gate."""

    @property
    def enabled(self) -> bool:
        """Whether the joints are energised."""

    @property
    def taken_over(self) -> tuple[str, ...]:
        """Joints that were taken over."""

    def open(self, *, take_over: bool = False) -> Capabilities:
        """Connect."""

    def read_energised(self) -> tuple[bool | None, ...]:
        """What the drives say."""

    def configure(self, mode: CommandMode, period: float) -> None:
        """Set mode and period."""

    def enable(self) -> None:
        """Energise."""

    def write(self, command: JointCommand) -> bool:
        """Send."""

    def read_into(self, feedback: JointFeedback) -> bool:
        """Receive."""

    def safe_stop(self, reason: str = "") -> None:
        """Stop."""

    def disable(self) -> None:
        """De-energise without latching."""

    def clear_faults(self) -> None:
        """Clear."""

    def close(self) -> None:
        """Let go."""


@dataclass(frozen=True)
class GoldenCommand:
    """A command and what must be on the wire for it.

    Attributes:
        torque: One entry a joint.
        wire: What the link must carry among the rest, as an independent encoder made it.
    """

    torque: Sequence[float]
    wire: Any


class AdapterRig(ABC):
    """An adapter, not yet opened, wired to drives that a test can look into.

    The adapter has a ramp time of zero, a torque rate that never limits and a position range wider than 1 rad to both
    sides; its drives may stand still under full torque, so that its `breakaway` limit is not below that of the torque.
    Clock, link and drives run in lock step.

    Attributes:
        adapter: The adapter.
        clock: Its clock.
        link: Its link.
        period: Control period [s].
        torque_limit: Of the configured limits, the same for all joints.
        exempt: Names of tests that the protocol rules out, with the reason.
    """

    adapter: AdapterUnderTest
    clock: VirtualClock
    link: FaultyLink
    period: float = 0.002
    torque_limit: float
    exempt: Mapping[str, str] = {}

    @abstractmethod
    def applied_torque(self) -> list[float]:
        """What each drive exerts now, in the unit and on the side of the joint."""

    @abstractmethod
    def energised(self) -> list[bool]:
        """Whether each drive is energised."""

    @abstractmethod
    def move(self, joint: int, position: float, velocity: float) -> None:
        """Put a joint at a position [rad] with a velocity [rad/s], joint side."""

    @abstractmethod
    def fail(self, joint: int) -> None:
        """Let a drive fault."""

    @abstractmethod
    def heal(self, joint: int) -> None:
        """Take the cause of the fault away; the drive still holds it latched."""

    @abstractmethod
    def power_cycle(self, joint: int) -> None:
        """Switch a drive off and on."""

    @abstractmethod
    def hold(self, joint: int) -> None:
        """Let somebody else energise a drive, with some torque, without a frame of the adapter's."""

    @abstractmethod
    def is_read(self, traffic: Any) -> bool:
        """Whether what the adapter handed to the link (one frame, or some bytes) only asks, and changes nothing."""

    @abstractmethod
    def refuse_mode(self) -> None:
        """Let the drives ignore a change of mode."""

    @abstractmethod
    def golden(self) -> Sequence[GoldenCommand]:
        """Commands and what an independent encoder makes of them."""
