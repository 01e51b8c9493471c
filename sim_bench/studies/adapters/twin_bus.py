"""A CAN bus in memory between an adapter and a drive twin, both in the same thread."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

import can

from fricomp.adapters.link import CanFrame


class TwinBus:
    """The adapter's link and the twin's port at once."""

    def __init__(self) -> None:
        self._to_twin: deque[can.Message] = deque()
        self._from_twin: list[CanFrame] = []
        self.twin: Any = None

    def send(self, frames: Any) -> None:
        """Frames of the adapter, or a message of the twin."""
        if isinstance(frames, can.Message):
            self._from_twin.append(CanFrame(frames.arbitration_id, bytes(frames.data), frames.is_extended_id))
            return
        self._to_twin.extend(map(as_message, frames))
        self.twin.pump()

    def receive(self) -> Sequence[CanFrame]:
        """What the twin has sent."""
        frames, self._from_twin = self._from_twin, []
        return frames

    def discard_output(self) -> None:
        """Nothing waits here."""

    def close(self) -> None:
        """Nothing is held here."""

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next message of the adapter."""
        return self._to_twin.popleft() if self._to_twin else None

    def shutdown(self) -> None:
        """Nothing is held here."""


def as_message(frame: CanFrame) -> can.Message:
    """The frame as python-can has it."""
    return can.Message(
        arbitration_id=frame.identifier,
        data=None if frame.remote else frame.data,
        is_extended_id=frame.extended,
        is_remote_frame=frame.remote,
    )
