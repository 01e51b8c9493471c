"""The side of the live page that the control loop sees: it hands over, and never waits."""

import contextlib
import queue
import secrets
import threading
import time
from collections.abc import Mapping, Sequence
from multiprocessing import get_context
from types import TracebackType
from typing import Any, Self

from fricomp.adapters import JointAdapter
from fricomp.calibration.sweep import BlockLabel, SweepData, measure_live_point
from fricomp.errors import AdapterError, SafetyTrip
from fricomp.joint import JointFeedback, stands_still
from fricomp.recording import Recording

from .ring import CycleRing
from .server import serve

__all__ = ["LiveFeed"]

STOPPED = "stopped on the live page"
_WAITING = 256
"""Messages that wait for the page at most; a page that does not take them misses what comes after."""
_PATIENCE = 20.0
"""Time within which the page must be there [s]."""
_FAREWELL = 2.0
"""Time that the page has to fetch the last state before it is taken away [s]."""


class LiveFeed:
    """The live page of one command, from `with` on. What is handed over is dropped where the page does not take it.

    Args:
        title: Heading of the page.

    Raises:
        AdapterError: The page cannot be served.
    """

    def __init__(self, title: str) -> None:
        context = get_context("spawn")
        self._pipe, other = context.Pipe()
        token = secrets.token_urlsafe(16)
        self._process = context.Process(target=serve, args=(other, token, title), daemon=True, name="fricomp-live")
        self._messages: queue.Queue[tuple[str, Any] | None] = queue.Queue(_WAITING)
        self._adapter: JointAdapter | None = None
        self._ring: CycleRing | None = None
        self._tare: SweepData = SweepData()
        self._origin_ns = 0
        self._paced_from = 0.0
        self.stopped = threading.Event()
        self._process.start()
        other.close()
        if not self._pipe.poll(_PATIENCE):
            self._process.terminate()
            raise AdapterError(f"the live page did not come up within {_PATIENCE:g} s: leave out --live")
        try:
            self.address = f"http://127.0.0.1:{self._pipe.recv()}/{token}/"
        except EOFError as error:
            raise AdapterError("the live page could not be served on 127.0.0.1: leave out --live") from error

    def __enter__(self) -> Self:
        for work in (self._send_messages, self._hear_stop):
            threading.Thread(target=work, daemon=True, name=f"live{work.__name__}").start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._let_go()
        said = "Done." if error is None else str(error) or "Interrupted."
        self._hand_over("end", {"text": said, "failed": error is not None})
        with contextlib.suppress(queue.Full):
            self._messages.put(None, timeout=_FAREWELL)
        self._process.join(_FAREWELL)
        self._process.terminate()
        self._process.join()
        if self._ring is not None:
            self._ring.close()

    # -- what a motion tells ----------------------------------------------------------------------------

    def attach(self, adapter: JointAdapter, joint: int = 0) -> None:
        """Show the joints of an adapter, which is open, until the next one; a simulated one is slowed to real time.

        Raises:
            SafetyTrip: Stop was pressed already.
        """
        if self.stopped.is_set():
            raise SafetyTrip(STOPPED)
        self._let_go()
        joints = adapter.capabilities.joints
        if self._ring is None or self._ring.n_joints != len(joints):
            if self._ring is not None:
                self._ring.close()
            self._ring = CycleRing(len(joints))
        told = [
            {"name": one.name, "unit": "rad" if one.motion == "rotary" else "m", "torque_unit": one.torque_unit}
            for one in joints
        ]
        limits = [limit.torque for limit in adapter.options.limits]
        self._hand_over("joints", {"ring": self._ring.name, "joints": told, "joint": joint, "limits": limits})
        self._paced_from = time.monotonic() if stands_still(adapter.clock) else 0.0
        self._origin_ns = adapter.clock.now_ns()
        self._adapter = adapter
        adapter.tap = self._note_cycle
        if self.stopped.is_set():  # between the first line and the last but one
            adapter.safe_stop(STOPPED)

    def show_progress(self, text: str, done: float) -> None:
        """Show what is being done, and the fraction of it that is done [1]."""
        self._hand_over("progress", {"text": text, "done": done})

    def show_duration(self, text: str, duration: float) -> None:
        """Show what begins now, and how long it will take [s]."""
        self._hand_over("progress", {"text": text, "done": 0.0, "duration": duration})

    def show_block(self, label: BlockLabel, samples: Recording) -> None:
        """Show what a block of a sweep tells: a plateau is a point of the curve, used or rejected."""
        if label.kind == "tare":
            self._tare = SweepData(((label, samples),))
        elif label.kind == "plateau":
            point = measure_live_point(self._tare.with_block(label, samples))
            if point is not None:
                self._hand_over("point", point)

    # -- inside -----------------------------------------------------------------------------------------

    def _note_cycle(self, feedback: JointFeedback, admitted: Sequence[float]) -> None:
        """In the control thread, once a cycle."""
        ring, elapsed = self._ring, (feedback.time_ns - self._origin_ns) * 1e-9
        if ring is not None:
            ring.write(elapsed, feedback, admitted)
        if self._paced_from:
            ahead = elapsed - (time.monotonic() - self._paced_from)
            if ahead > 0.0:
                time.sleep(ahead)

    def _let_go(self) -> None:
        if self._adapter is not None:
            self._adapter.tap = None
        self._adapter = None

    def _hand_over(self, kind: str, content: Mapping[str, Any]) -> None:
        with contextlib.suppress(queue.Full):
            self._messages.put_nowait((kind, content))

    def _send_messages(self) -> None:
        """In a thread of its own: the pipe may be full, or nobody at its other end."""
        with contextlib.suppress(OSError):
            while True:
                message = self._messages.get()
                self._pipe.send(message)
                if message is None:
                    return

    def _hear_stop(self) -> None:
        """In a thread of its own, which sleeps until the page says stop."""
        with contextlib.suppress(EOFError, OSError):
            while self._pipe.recv() != "stop":
                pass
            self.stopped.set()
            if (adapter := self._adapter) is not None:
                adapter.safe_stop(STOPPED)
