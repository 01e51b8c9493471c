"""Round trips over slcan on one pseudo-terminal: the chunked bus against python-can's own."""

import os
import subprocess
import sys
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from statistics import median
from typing import Literal

import can

from fricomp.adapters.slcan import ChunkedSlcanBus

__all__ = ["ECHOES", "Echo", "RoundTrip", "compare_slcan"]

# Another process sends every line back, as an adapter whose bus has one echoing node.
ECHO = """
import os, sys
descriptor = int(sys.argv[1])
while True:
    data = os.read(descriptor, 65536)
    if not data:
        break
    os.write(descriptor, b"".join(line + b"\\r" for line in data.split(b"\\r") if line[:1] in b"tT" and line))
"""

Echo = Literal["another process", "same thread"]
ECHOES: tuple[Echo, ...] = ("same thread", "another process")


@dataclass(frozen=True)
class RoundTrip:
    """Time for some frames to go out and come back.

    Attributes:
        n_frames: Sent together.
        echo: Who sends them back: another process, which the system has to wake, or the same thread, so that nothing
            but the buses' own work counts.
        chunked: Median with the chunked bus [s].
        bytewise: Median with python-can's bus [s].
    """

    n_frames: int
    echo: Echo
    chunked: float
    bytewise: float

    @property
    def ratio(self) -> float:
        """How many times faster the chunked bus is."""
        return self.bytewise / self.chunked


def compare_slcan(n_frames: int, echo: Echo, repeats: int) -> RoundTrip:
    """Send frames together and wait for all of them, `repeats` times on each bus, over the same pseudo-terminal."""
    with _open_terminal(echo) as (path, send_back):
        chunked = ChunkedSlcanBus(path)
        first = _measure_time(chunked, send_back, n_frames, repeats)
        chunked.shutdown()
        bytewise = can.Bus(interface="slcan", channel=path, bitrate=1_000_000, sleep_after_open=0.1)
        second = _measure_time(bytewise, send_back, n_frames, repeats)
        bytewise.shutdown()
    return RoundTrip(n_frames, echo, first, second)


@contextmanager
def _open_terminal(echo: Echo) -> Iterator[tuple[str, Callable[[int], None]]]:
    """A pseudo-terminal, and what lets the frames come back."""
    device, user = os.openpty()
    tty.setraw(user)
    process = None
    if echo == "another process":
        process = subprocess.Popen([sys.executable, "-c", ECHO, str(device)], pass_fds=[device])
    try:
        yield os.ttyname(user), _do_nothing if process is not None else partial(_send_back, device)
    finally:
        if process is not None:
            process.kill()
            process.wait()
        os.close(device)
        os.close(user)


def _do_nothing(n_frames: int) -> None:
    return


def _send_back(device: int, n_frames: int) -> None:
    """Send frames back once all have come; what opens the channel is swallowed."""
    data = b""
    while data.count(b"t") < n_frames:
        data += os.read(device, 65536)
    os.write(device, data[data.index(b"t") :])


def _measure_time(bus: can.BusABC, send_back: Callable[[int], None], n_frames: int, repeats: int) -> float:
    messages = [
        can.Message(arbitration_id=0x181 + number, data=bytes(range(8)), is_extended_id=False)
        for number in range(n_frames)
    ]
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        for message in messages:
            bus.send(message)
        send_back(n_frames)
        for _ in messages:
            if bus.recv(2.0) is None:
                raise can.CanOperationError("a frame did not come back")
        times.append(time.perf_counter() - start)
    return median(times)
