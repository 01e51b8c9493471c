"""Round trips over slcan on one pseudo-terminal: the chunked bus against python-can's own."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median

import can

from fricomp.adapters.slcan import ChunkedSlcanBus

__all__ = ["RoundTrip", "compare_slcan"]

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


@dataclass(frozen=True)
class RoundTrip:
    """Time for some frames to go out and come back.

    Attributes:
        n_frames: Sent together.
        chunked: Median with the chunked bus [s].
        bytewise: Median with python-can's bus [s].
    """

    n_frames: int
    chunked: float
    bytewise: float

    @property
    def ratio(self) -> float:
        """How many times faster the chunked bus is."""
        return self.bytewise / self.chunked


def compare_slcan(n_frames: int, repeats: int = 200) -> RoundTrip:
    """Send frames together and wait for all of them, `repeats` times on each bus, over the same pseudo-terminal."""
    with _echo() as path:
        chunked = ChunkedSlcanBus(path)
        first = _time(chunked, n_frames, repeats)
        chunked.shutdown()
        bytewise = can.Bus(interface="slcan", channel=path, bitrate=1_000_000, sleep_after_open=0.1)
        second = _time(bytewise, n_frames, repeats)
        bytewise.shutdown()
    return RoundTrip(n_frames, first, second)


@contextmanager
def _echo() -> Iterator[str]:
    device, user = os.openpty()
    tty.setraw(user)
    process = subprocess.Popen([sys.executable, "-c", ECHO, str(device)], pass_fds=[device])
    try:
        yield os.ttyname(user)
    finally:
        process.kill()
        process.wait()
        os.close(device)
        os.close(user)


def _time(bus: can.BusABC, n_frames: int, repeats: int) -> float:
    messages = [
        can.Message(arbitration_id=0x181 + number, data=bytes(range(8)), is_extended_id=False)
        for number in range(n_frames)
    ]
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        for message in messages:
            bus.send(message)
        for _ in messages:
            if bus.recv(2.0) is None:
                raise can.CanOperationError("a frame did not come back")
        times.append(time.perf_counter() - start)
    return median(times)
