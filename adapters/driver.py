"""What a driver implements, on the drive's own side of the transmission and in SI."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Self

from fricomp.joint import Capabilities, CommandMode, JointCommand, JointFeedback, Watchdog

__all__ = ["HOW_TO_CLEAR", "Driver"]

HOW_TO_CLEAR = "clear_faults(), or fricomp adapter clear, once the cause is gone"
"""For the message of a `DriveFault`."""


class Driver(ABC):
    """The private half of an adapter. Nothing here blocks longer than a fraction of a period, but for opening,
    configuring, enabling and clearing. Only errors of `fricomp.errors` are raised.

    `_stop` may be called from another thread while `_write` or `_read_into` runs; the rest is called by one thread.
    """

    @classmethod
    @abstractmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make the adapter from what stands in the configuration file.

        Raises:
            AdapterConfigurationError: A key is unknown or a value is wrong.
        """

    @abstractmethod
    def _open(self) -> Capabilities:
        """Connect, read scaling and limits; energise nothing."""

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

    def _confirmed_watchdog(self) -> Watchdog | None:
        """The watchdog as read back after `_configure`; None if it is what `_open` declared."""
        return None

    def _health(self) -> dict[str, float | str]:
        """Counters and states, for display."""
        return {}
