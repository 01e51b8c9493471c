"""What a driver implements, on the drive's own side of the transmission and in SI."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from fricomp.joint import Capabilities, CommandMode, JointCommand, JointFeedback, Watchdog


class Driver(ABC):
    """The private half of an adapter. Nothing here blocks longer than a fraction of a period, but for opening,
    configuring, enabling and clearing. Only errors of `fricomp.errors` are raised.

    `_stop` may be called from another thread while `_write` or `_read_into` runs; the rest is called by one thread.

    Attributes:
        configuration_file: Where the configuration was read from, for messages; none where it was not.
        watchdog_faults: Codes that a drive reports when nothing but its own watchdog has stopped it.
    """

    configuration_file: Path | None = None
    watchdog_faults: frozenset[int] = frozenset()

    @classmethod
    @abstractmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make the adapter from what stands in the configuration file.

        Raises:
            AdapterConfigurationError: A key is unknown or a value is wrong.
        """

    @abstractmethod
    def _open(self) -> Capabilities:
        """Connect, read scaling and limits; write nothing to a drive, which somebody else may hold."""

    @abstractmethod
    def _configure(self, mode: CommandMode, period: float) -> None:
        """Write mode, watchdog and period; read them back."""

    @abstractmethod
    def _enable(self) -> None:
        """Command zero, confirm the mode, energise."""

    @abstractmethod
    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        """Send one whole command."""

    @abstractmethod
    def _read_into(self, feedback: JointFeedback) -> bool:
        """Fill in what has come; False if nothing has."""

    @abstractmethod
    def _stop(self) -> None:
        """Zero torque and de-energise, discarding whatever is queued; best effort, raises `AdapterError` only."""

    @abstractmethod
    def _clear_faults(self) -> None:
        """Clear what the drives have latched."""

    @abstractmethod
    def _close(self) -> None:
        """Let go of the bus."""

    def _end_motion(self) -> None:
        """What drives need that were stopped in the ordinary way and are read at rest now; most need nothing."""
        return

    def _take_over(self) -> None:
        """Zero torque and de-energise drives that somebody else has energised, and may have set up in any way."""
        self._stop()

    def _command_line(self, command: str, *options: str) -> str:
        """How the user calls `fricomp adapter` for these drives, for messages."""
        return " ".join(("fricomp adapter", command, str(self.configuration_file or "FILE"), *options))

    @property
    def _how_to_clear(self) -> str:
        """For the message of a `DriveFault`."""
        return f"clear_faults(), or {self._command_line('clear')}, once the cause is gone"

    def _describe_fault(self, joint: int, code: int) -> str:
        """What a code of the drive of a joint means, in words; empty where nobody says so."""
        return ""

    def _ask_faults(self) -> Sequence[int] | None:
        """Ask the drives which faults they report now, and judge nothing; None where that cannot be asked."""
        return None

    def _confirmed_watchdog(self) -> Watchdog | None:
        """The watchdog as read back after `_configure`; None if it is what `_open` declared."""
        return None

    def _health(self) -> dict[str, float | str]:
        """Counters and states, for display."""
        return {}


def name_bits(code: int, words: Mapping[int, str]) -> str:
    """The words of the bits that are set in a code; empty where one of them has none."""
    named = [word for bit, word in words.items() if code & bit]
    return "" if code & ~sum(words) else ", ".join(named)
