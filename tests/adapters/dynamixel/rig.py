"""Two Dynamixel servos in memory behind their adapter, and the vendor's package as an encoder beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from dynamixel_sdk import Protocol2PacketHandler

from fricomp.adapters.configuration import convert
from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.dynamixel.configuration import DynamixelConfiguration
from fricomp.adapters.link import SerialLink
from fricomp.sim_bench.stand_in import StandIn, default_joint
from fricomp.sim_bench.studies.adapters.hand_held import HandHeldAxis
from fricomp.sim_bench.twins.dynamixel.line import DynamixelServo, DynamixelSettings, DynamixelTwin
from fricomp.sim_bench.twins.dynamixel.packet import PacketReader
from fricomp.sim_bench.twins.memory import MemorySerialLine
from fricomp.testing import AdapterRig, FaultyLink, GoldenCommand, VirtualClock
from tests.adapters.peers.rig import joint_tables

# A gear turns positions and velocities; of a torque counted in amperes only the sign.
GEARS, SIGNS = (1.0, -2.0), (1.0, -1.0)
GOAL_CURRENT, OPERATING_MODE, INDIRECT_DATA = 102, 11, 224


class Servo(DynamixelServo):
    """The twin's servo, with faults on demand."""

    failing = keeps_mode = False

    def tick(self, now_ns: int) -> None:
        if self.failing:
            self.fail()
        super().tick(now_ns)

    def write(self, address: int, data: bytes) -> int:
        return 0 if self.keeps_mode and address == OPERATING_MODE else super().write(address, data)


def configuration(**changes: Any) -> dict[str, Any]:
    joints = joint_tables(2, torque=1.0, velocity=12.0)
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    return {"serial": {"port": "loop://"}, "joints": joints, "ramp_time": 0.0} | changes


class DynamixelRig(AdapterRig):
    """Two servos, the second behind a gear that turns the other way.

    Args:
        line: Puts something between adapter and bus.
        changes: Of the configuration.
    """

    def __init__(self, line: Callable[[SerialLink, VirtualClock], Any] | None = None, **changes: Any) -> None:
        self.torque_limit, self.period = 1.0, 0.004
        self.clock = VirtualClock()
        self.axes = [HandHeldAxis(), HandHeldAxis()]
        settings = [DynamixelSettings(identifier, torque_constant=1.0, velocity_limit=1023) for identifier in (1, 2)]
        self.servos = [Servo(cast(Any, axis), setting) for axis, setting in zip(self.axes, settings, strict=True)]
        memory = MemorySerialLine()
        memory.on_sent = DynamixelTwin(memory, StandIn(default_joint()), self.servos).pump
        self.clock.follow(self._tick)
        self.link = FaultyLink(line(memory.link, self.clock) if line is not None else memory.link)
        made = convert(configuration(**changes), DynamixelConfiguration)
        self.adapter = DynamixelAdapter(made, lambda: self.link, self.clock)

    def _tick(self, now_ns: int) -> None:
        for servo in self.servos:
            servo.tick(now_ns)

    def applied_torque(self) -> list[float]:
        return [axis.torque * sign for axis, sign in zip(self.axes, SIGNS, strict=True)]

    def energised(self) -> list[bool]:
        return [axis.energised for axis in self.axes]

    def move(self, joint: int, position: float, velocity: float) -> None:
        self.axes[joint].position, self.axes[joint].velocity = position * GEARS[joint], velocity * GEARS[joint]

    def fail(self, joint: int) -> None:
        self.servos[joint].failing = True

    def heal(self, joint: int) -> None:
        self.servos[joint].failing = False

    def power_cycle(self, joint: int) -> None:
        self.servos[joint].power_cycle()

    def refuse_mode(self) -> None:
        for servo in self.servos:
            servo.keeps_mode = True

    def hold(self, joint: int) -> None:
        servo = self.servos[joint]
        servo.write(98, b"\0")
        servo.write(64, b"\1")
        servo.write(GOAL_CURRENT, (100).to_bytes(2, "little"))

    def is_read(self, traffic: bytes) -> bool:
        """Packets that ping or read, one servo or several."""
        packets = list(PacketReader().feed(traffic))
        return bool(packets) and all(packet[1] in (0x01, 0x02, 0x82, 0x92) for packet in packets)

    def golden(self) -> Sequence[GoldenCommand]:
        """The goals of both servos and the request for their states, as the vendor's package makes them."""
        sdk = SdkPort()
        golden = []
        for count in (100, -37):
            data = [1, *count.to_bytes(2, "little", signed=True), 2, 0, 0]
            goals = sdk.sync_write(GOAL_CURRENT, 2, data)
            golden.append(GoldenCommand((count * 2.69e-3, 0.0), goals + sdk.sync_read(INDIRECT_DATA, 14, [1, 2])))
        return golden


class SdkPort:
    """Catches what the vendor's package sends."""

    is_using = False

    def __init__(self) -> None:
        self.sent = b""

    def clearPort(self) -> None:  # noqa: N802
        """Nothing to clear."""

    def writePort(self, packet: Sequence[int]) -> int:  # noqa: N802
        self.sent += bytes(packet)
        return len(packet)

    def setPacketTimeout(self, length: int) -> None:  # noqa: N802
        """Nothing is received."""

    def _catch(self) -> bytes:
        sent, self.sent, self.is_using = self.sent, b"", False
        return sent

    def sync_write(self, address: int, n_bytes: int, data: Sequence[int]) -> bytes:
        Protocol2PacketHandler().syncWriteTxOnly(self, address, n_bytes, list(data), len(data))
        return self._catch()

    def sync_read(self, address: int, n_bytes: int, servos: Sequence[int]) -> bytes:
        Protocol2PacketHandler().syncReadTx(self, address, n_bytes, list(servos), len(servos), False)
        return self._catch()
