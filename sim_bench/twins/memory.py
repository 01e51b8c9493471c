"""Lines in memory between an adapter and a twin in the same thread: what is sent is answered before `send` returns."""

from collections import deque
from collections.abc import Callable, Sequence

import can

from fricomp.adapters.link import CanFrame


class MemoryCanLine:
    """A CAN bus: `link` is the adapter's end, the object itself the twin's."""

    def __init__(self) -> None:
        self.to_twin: deque[can.Message] = deque()
        self.to_adapter: list[CanFrame] = []
        self.on_sent: Callable[[], object] = lambda: None
        """Called once the adapter has sent; the twin's `pump`."""
        self.link = _CanLink(self)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame for the twin."""
        return self.to_twin.popleft() if self.to_twin else None

    def send(self, msg: can.Message) -> None:
        """A frame of the twin."""
        frame = CanFrame(msg.arbitration_id, bytes(msg.data), msg.is_extended_id, msg.is_remote_frame)
        self.to_adapter.append(frame)

    def shutdown(self) -> None:
        """Nothing is held here."""


class _CanLink:
    """The adapter's end of a CAN line."""

    def __init__(self, line: MemoryCanLine) -> None:
        self._line = line

    def send(self, frames: Sequence[CanFrame]) -> None:
        """Frames of the adapter."""
        for frame in frames:
            self._line.to_twin.append(
                can.Message(
                    arbitration_id=frame.identifier,
                    data=None if frame.remote else frame.data,
                    is_extended_id=frame.extended,
                    is_remote_frame=frame.remote,
                )
            )
        self._line.on_sent()

    def receive(self) -> Sequence[CanFrame]:
        """All frames for the adapter."""
        frames, self._line.to_adapter = self._line.to_adapter, []
        return frames

    def discard_output(self) -> None:
        """What the twin has not taken."""
        self._line.to_twin.clear()

    def close(self) -> None:
        """Nothing is held here."""


class MemorySerialLine:
    """A serial line: `link` is the adapter's end, the object itself the twin's."""

    def __init__(self) -> None:
        self.to_twin, self.to_adapter = b"", b""
        self.on_sent: Callable[[], object] = lambda: None
        """Called once the adapter has sent; the twin's `pump`."""
        self.link = _SerialLink(self)

    @property
    def address(self) -> str:
        """No other process reaches it."""
        return "memory"

    def read(self) -> bytes:
        """All bytes for the twin."""
        data, self.to_twin = self.to_twin, b""
        return data

    def write(self, data: bytes) -> None:
        """Bytes of the twin."""
        self.to_adapter += data

    def close(self) -> None:
        """Nothing is held here."""


class _SerialLink:
    """The adapter's end of a serial line."""

    def __init__(self, line: MemorySerialLine) -> None:
        self._line = line

    def send(self, data: bytes) -> None:
        """Bytes of the adapter."""
        self._line.to_twin += data
        self._line.on_sent()

    def receive(self) -> bytes:
        """All bytes for the adapter."""
        data, self._line.to_adapter = self._line.to_adapter, b""
        return data

    def discard_output(self) -> None:
        """What the twin has not taken."""
        self._line.to_twin = b""

    def close(self) -> None:
        """Nothing is held here."""
