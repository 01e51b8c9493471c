"""CAN through python-can, any interface of it; reads everything that has come, never waits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from fricomp.errors import AdapterConnectionError

from .frame import CanFrame

if TYPE_CHECKING:
    import can

__all__ = ["CanLink", "PythonCanLink"]

SEND_TIMEOUT = 0.002
"""How long a frame may wait for a place in the controller's queue [s]; longer, and the bus is taken for dead."""

# Of socketcan's error frames: the bus-off bit of the identifier (linux/can/error.h).
BUS_OFF = 0x40
IS_BUS_OFF = "the CAN controller is bus-off: check wiring, termination and bit rate"
MOST_FRAMES_AT_ONCE = 1000


class CanLink(Protocol):
    """What an adapter needs of a CAN bus. Errors are `AdapterConnectionError`."""

    def send(self, frames: Sequence[CanFrame]) -> None:
        """Hand over all frames in order; from any thread."""

    def receive(self) -> Sequence[CanFrame]:
        """All frames that have come; empty at once if none has."""

    def discard_output(self) -> None:
        """Drop what still waits to be sent, where the interface can."""

    def close(self) -> None:
        """Let go of the bus."""


class PythonCanLink:
    """A python-can bus.

    Args:
        bus: Opened already; closed by `close`.
    """

    def __init__(self, bus: can.BusABC) -> None:
        import can

        self._bus = bus
        self._message, self._bus_off = can.Message, can.BusState.ERROR
        self._n_errors = 0

    @property
    def n_errors(self) -> int:
        """Error frames and damaged lines so far, those that the interface has counted itself included."""
        return self._n_errors + int(getattr(self._bus, "n_damaged", 0))

    def send(self, frames: Sequence[CanFrame]) -> None:
        """Hand over all frames in order; none is handed over unless all can be built.

        Raises:
            AdapterConnectionError: The queue stays full, or the bus is gone.
        """
        make = self._message
        try:
            messages = [
                make(
                    arbitration_id=identifier, data=data, is_extended_id=extended, is_remote_frame=remote, dlc=len(data)
                )
                for identifier, data, extended, remote in frames
            ]
            for message in messages:
                self._bus.send(message, SEND_TIMEOUT)
        except Exception as error:  # interfaces raise CanError, OSError, serial and vendor errors alike
            raise AdapterConnectionError(f"cannot send on the CAN bus: {error}") from error

    def receive(self) -> Sequence[CanFrame]:
        """All frames that have come, at most a thousand at once; garbage is counted and skipped.

        Raises:
            AdapterConnectionError: The bus is off or gone.
        """
        frames: list[CanFrame] = []
        for _ in range(MOST_FRAMES_AT_ONCE):
            try:
                message = self._bus.recv(0.0)
            except (IndexError, ValueError):  # what serial interfaces raise on a damaged line
                self._n_errors += 1
                continue
            except Exception as error:
                raise AdapterConnectionError(f"cannot receive from the CAN bus: {error}") from error
            if message is None:
                break
            if message.is_error_frame:
                self._on_error_frame(message.arbitration_id)
            elif not message.is_remote_frame:
                frames.append(CanFrame(message.arbitration_id, bytes(message.data), message.is_extended_id))
        if not frames and getattr(self._bus, "state", None) is self._bus_off:
            raise AdapterConnectionError(IS_BUS_OFF)
        return frames

    def _on_error_frame(self, identifier: int) -> None:
        self._n_errors += 1
        if identifier & BUS_OFF:
            raise AdapterConnectionError(IS_BUS_OFF)

    def discard_output(self) -> None:
        """Drop what still waits to be sent, where the interface can."""
        try:
            self._bus.flush_tx_buffer()
        except Exception:  # most interfaces have no such queue, or none to drop
            return

    def close(self) -> None:
        """Let go of the bus.

        Raises:
            AdapterConnectionError: The interface fails to.
        """
        try:
            self._bus.shutdown()
        except Exception as error:
            raise AdapterConnectionError(f"the CAN bus does not close: {error}") from error
