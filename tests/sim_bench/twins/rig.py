"""A twin on an ideal joint, and its peer on the other end of the bus."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from time import monotonic, sleep

import can

from fricomp.sim_bench.stand_in import SensorSettings, StandIn, StandInSettings, default_joint
from fricomp.sim_bench.twins import DriveAxis, DriveTwin, twin_stand_in
from fricomp.sim_bench.twins.can_twin import CanDevice, CanTwin

# Longest wait for another thread [s]; reached only when something is broken.
PATIENCE = 5.0

_channels = count()


def ideal_joint() -> StandInSettings:
    """The default joint with sensors that show the truth at once."""
    settings = default_joint(sensor=SensorSettings.ideal())
    return replace(settings, joints=tuple(replace(joint, position=0.25) for joint in settings.joints))


def fresh_channel() -> str:
    """A virtual bus of its own for each test."""
    return f"twin-{next(_channels)}"


@contextmanager
def can_rig(make: Callable[[DriveAxis], CanDevice], channel: str | None = None) -> Iterator[CanRig]:
    """A twin of one device and a bus to talk to it."""
    channel = channel or fresh_channel()
    stand_in = twin_stand_in(ideal_joint())
    port = can.Bus(interface="virtual", channel=channel)
    device = make(DriveAxis(stand_in))
    with CanTwin(port, stand_in, [device]) as twin, can.Bus(interface="virtual", channel=channel) as bus:
        yield CanRig(twin, stand_in, bus, channel)


class CanRig:
    """Frames in, frames out, and time in between."""

    def __init__(self, twin: DriveTwin, stand_in: StandIn, bus: can.BusABC, channel: str) -> None:
        self.twin, self.stand_in, self.bus, self.channel = twin, stand_in, bus, channel

    def send(self, identifier: int, data: bytes = b"", *, remote: bool = False) -> None:
        self.bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False, is_remote_frame=remote))

    def received(self) -> list[tuple[int, bytes]]:
        """What has come since the last call."""
        frames = []
        while (message := self.bus.recv(0.0)) is not None:
            frames.append((message.arbitration_id, bytes(message.data)))
        return frames

    def ask(self, identifier: int, data: bytes = b"", *, remote: bool = False) -> list[tuple[int, bytes]]:
        """Send a frame and take the answers."""
        self.received()
        self.send(identifier, data, remote=remote)
        self.twin.pump()
        return self.received()

    def steps(self, number: int) -> None:
        for _ in range(number):
            self.twin.step()


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait for another thread to bring this about."""
    end = monotonic() + PATIENCE
    while not condition():
        assert monotonic() < end, "it did not come about"
        sleep(0.001)
