"""The conformance rig over peers in memory, and the configuration they all share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fricomp.adapters import JointAdapter
from fricomp.testing import AdapterRig, FaultyLink, GoldenCommand, VirtualClock
from tests.adapters.peers.bus import Peer, PeerBus


def joint_tables(n_joints: int, torque: float, velocity: float, **extra: Any) -> list[dict[str, Any]]:
    """Configuration of some joints; the second one turns the other way, with a gear of two."""
    tables: list[dict[str, Any]] = []
    for joint in range(n_joints):
        limits = {"torque": torque, "torque_rate": 1e9, "velocity": velocity, "position": (-3.0, 3.0)}
        limits["breakaway"] = 1e3  # drives in a test's hand stand still under any torque
        tables.append({"name": f"joint {joint}", "id": joint + 1, "limits": limits, **extra})
    return tables


class PeerRig(AdapterRig):
    """A rig over peers; transmissions are undone here, independently of the adapter's."""

    def __init__(
        self,
        make_adapter: Callable[[Callable[[], Any], VirtualClock], JointAdapter],
        peers: Sequence[Peer],
        torque_limit: float,
        gears: Sequence[float] = (1.0, 1.0),
    ) -> None:
        self.clock = VirtualClock()
        self.peers = peers
        self.gears = gears
        self.torque_limit = torque_limit
        self.link = FaultyLink(self.make_bus())
        self.adapter = make_adapter(lambda: self.link, self.clock)

    def make_bus(self) -> Any:
        return PeerBus(self.peers, self.clock)

    def applied_torque(self) -> list[float]:
        return [peer.torque * gear for peer, gear in zip(self.peers, self.gears, strict=True)]

    def energised(self) -> list[bool]:
        return [peer.on for peer in self.peers]

    def move(self, joint: int, position: float, velocity: float) -> None:
        self.peers[joint].position = position * self.gears[joint]
        self.peers[joint].velocity = velocity * self.gears[joint]

    def fail(self, joint: int) -> None:
        self.peers[joint].failed = True

    def heal(self, joint: int) -> None:
        self.peers[joint].failed = False

    def power_cycle(self, joint: int) -> None:
        peer = self.peers[joint]
        kept = (peer.position, peer.velocity, peer.now_ns)
        peer.__init__(*peer.made_of)  # type: ignore[misc, attr-defined]
        peer.position, peer.velocity, peer.now_ns = kept

    def hold(self, joint: int) -> None:
        peer = self.peers[joint]
        peer.on = peer.held = True
        peer.torque = 1.0

    def is_read(self, traffic: Any) -> bool:
        raise NotImplementedError

    def refuse_mode(self) -> None:
        for peer in self.peers:
            peer.refuses_mode = True

    def golden(self) -> Sequence[GoldenCommand]:
        return []
