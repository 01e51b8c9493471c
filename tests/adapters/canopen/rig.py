"""Two CiA 402 drives behind the adapter; the second one has a gear of two and turns the other way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fricomp.adapters.canopen import CanOpenAdapter
from fricomp.adapters.canopen.configuration import CanOpenConfiguration
from fricomp.adapters.configuration import convert
from fricomp.adapters.link import CanFrame
from fricomp.testing import GoldenCommand
from tests.adapters.peers.cia402 import Cia402Peer
from tests.adapters.peers.rig import PeerRig, joint_tables


def configuration(**changes: Any) -> dict[str, Any]:
    joints = joint_tables(2, torque=4.0, velocity=20.0)
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    base = {"bus": {"interface": "virtual"}, "joints": joints, "ramp_time": 0.0}
    return base | changes


class CanOpenRig(PeerRig):
    def __init__(self, **changes: Any) -> None:
        self.drives = [Cia402Peer(1), Cia402Peer(2)]
        self.made = convert(configuration(**changes), CanOpenConfiguration)
        super().__init__(
            lambda link, clock: CanOpenAdapter(self.made, link, clock), self.drives, 4.0, gears=(1.0, -2.0)
        )

    def hold(self, joint: int) -> None:
        super().hold(joint)
        self.drives[joint].state = "operation enabled"
        self.drives[joint].store(0x6040, 0x0F)

    def is_read(self, traffic: CanFrame) -> bool:
        """Reading by SDO: client command specifiers 2 and 3."""
        return 0x600 < traffic.identifier < 0x680 and traffic.data[0] >> 5 in (2, 3)

    def golden(self) -> Sequence[GoldenCommand]:
        """RPDO by hand: controlword 15, then thousandths of 5 N·m; joint 1 has a gear of -2."""
        return [
            GoldenCommand((1.0, 0.0), CanFrame(0x201, bytes.fromhex("0f00c800"))),
            GoldenCommand((-0.005, 2.0), CanFrame(0x201, bytes.fromhex("0f00ffff"))),
            GoldenCommand((0.0, 2.0), CanFrame(0x202, bytes.fromhex("0f0038ff"))),
        ]
