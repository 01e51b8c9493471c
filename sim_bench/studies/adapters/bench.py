"""An adapter and its twin without dynamics, in memory and in lock step: what the measurements are made on."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fricomp.adapters import JointAdapter
from fricomp.adapters.configuration import convert
from fricomp.testing import FaultyLink, VirtualClock

from ...twins.memory import MemoryCanLine, MemorySerialLine
from .hand_held import HandHeldAxis

__all__ = ["PERIOD", "PROTOCOLS", "TORQUE_LIMIT", "AdapterBench", "make_bench"]

TORQUE_LIMIT = 2.0
PERIOD = 0.005
# Motors in a hand stand still under any torque.
LIMITS = {"torque": TORQUE_LIMIT, "torque_rate": 1e9, "velocity": 8.0, "position": (-3.0, 3.0), "breakaway": 1e3}


@dataclass
class AdapterBench:
    """One adapter with its drives.

    Attributes:
        adapter: Not opened yet.
        axes: Motors of its drives.
        link: Between them.
        clock: Of all.
        twin: The drives.
        line: What the link reaches them over.
    """

    adapter: JointAdapter
    axes: list[HandHeldAxis]
    link: FaultyLink
    clock: VirtualClock
    twin: Any
    line: Any

    def start(self) -> None:
        """Open, configure and enable; the ramp is over."""
        self.adapter.open()
        self.adapter.configure("torque", PERIOD)
        self.adapter.enable()
        self.clock.advance(PERIOD)


def _make_tables(n_joints: int, **extra: Any) -> list[dict[str, Any]]:
    return [{"name": f"joint {n}", "id": n, "limits": LIMITS, **extra} for n in range(1, n_joints + 1)]


def _make_common(n_joints: int, **extra: Any) -> dict[str, Any]:
    return {"joints": _make_tables(n_joints, **extra), "ramp_time": 0.0}


_NO_JOINTS: Any = None
"""In place of the simulated joints of a twin: the motors are in a hand."""


def _make_bench(
    line: Any,
    make_twin: Callable[[list[Any]], Any],
    make_adapter: Callable[[Any, VirtualClock], JointAdapter],
    n_joints: int,
) -> AdapterBench:
    """A twin of these motors at one end of a line in memory, an adapter at the other."""
    clock, axes = VirtualClock(), [HandHeldAxis() for _ in range(n_joints)]
    twin = make_twin(axes)
    line.on_sent = twin.pump
    clock.follow(copy(twin)._tick)  # of all drives, also of one that is taken off the bus later
    link = FaultyLink(line.link)
    return AdapterBench(make_adapter(link, clock), axes, link, clock, twin, line)


def _can_bench(
    make_device: Callable[[Any, int], Any], make_adapter: Callable[[Any, VirtualClock], JointAdapter], n_joints: int
) -> AdapterBench:
    from ...twins.can_twin import CanTwin

    line = MemoryCanLine()

    def make_twin(axes: list[Any]) -> CanTwin:
        return CanTwin(line, _NO_JOINTS, [make_device(axis, number) for number, axis in enumerate(axes, start=1)])

    return _make_bench(line, make_twin, make_adapter, n_joints)


def make_canopen(n_joints: int) -> AdapterBench:
    """CiA 402."""
    from fricomp.adapters.canopen import CanOpenAdapter
    from fricomp.adapters.canopen.configuration import CanOpenConfiguration

    from ...twins.canopen.cia402 import Cia402Drive, Cia402Settings

    made = convert({"bus": {"interface": "virtual"}} | _make_common(n_joints), CanOpenConfiguration)
    return _can_bench(
        lambda axis, number: Cia402Drive(axis, Cia402Settings(node_id=number, rated_torque=5.0)),
        lambda link, clock: CanOpenAdapter(made, lambda: link, clock),
        n_joints,
    )


def make_mit(n_joints: int) -> AdapterBench:
    """Damiao."""
    from fricomp.adapters.mit import MitAdapter
    from fricomp.adapters.mit.configuration import MitConfiguration

    from ...twins.mit.damiao import MitMotor, MitSettings

    table = {"bus": {"interface": "virtual"}} | _make_common(n_joints, model="damiao/DM4310")
    made = convert(table, MitConfiguration)
    return _can_bench(
        lambda axis, number: MitMotor(axis, MitSettings(receive_id=number, feedback_id=0x10 + number)),
        lambda link, clock: MitAdapter(made, lambda: link, clock),
        n_joints,
    )


def make_odrive(n_joints: int) -> AdapterBench:
    """Firmware 0.6 with its endpoints."""
    from fricomp.adapters.odrive import OdriveAdapter
    from fricomp.adapters.odrive.configuration import OdriveConfiguration

    from ...twins.odrive import ODriveNode, ODriveSettings, flat_endpoints

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flat_endpoints.json"
        path.write_text(json.dumps(flat_endpoints()))
        table = {"bus": {"interface": "virtual"}, "endpoints": str(path)} | _make_common(n_joints)
        made = convert(table, OdriveConfiguration)
        return _can_bench(
            lambda axis, number: ODriveNode(axis, ODriveSettings(node=number)),
            lambda link, clock: OdriveAdapter(made, lambda: link, clock),
            n_joints,
        )


def make_moteus(n_joints: int) -> AdapterBench:
    """Behind an fdcanusb."""
    from fricomp.adapters.moteus import MoteusAdapter
    from fricomp.adapters.moteus.adapter import MoteusConfiguration

    from ...twins.moteus.bus import MoteusController, MoteusSettings, MoteusTwin

    line = MemorySerialLine()
    made = convert({"serial": {"port": "loop://"}} | _make_common(n_joints), MoteusConfiguration)

    def make_twin(axes: list[Any]) -> MoteusTwin:
        controllers = [MoteusController(axis, MoteusSettings(number)) for number, axis in enumerate(axes, start=1)]
        return MoteusTwin(line, _NO_JOINTS, controllers)

    return _make_bench(line, make_twin, lambda link, clock: MoteusAdapter(made, lambda: link, clock), n_joints)


def make_dynamixel(n_joints: int) -> AdapterBench:
    """Current mode, in amperes."""
    from fricomp.adapters.dynamixel import DynamixelAdapter
    from fricomp.adapters.dynamixel.configuration import DynamixelConfiguration

    from ...twins.dynamixel.line import DynamixelServo, DynamixelSettings, DynamixelTwin

    line = MemorySerialLine()
    table = {"serial": {"port": "loop://", "baudrate": 4_000_000}} | _make_common(n_joints)
    made = convert(table, DynamixelConfiguration)

    def make_twin(axes: list[Any]) -> DynamixelTwin:
        settings = [DynamixelSettings(number, torque_constant=1.0) for number in range(1, n_joints + 1)]
        return DynamixelTwin(line, _NO_JOINTS, list(map(DynamixelServo, axes, settings)))

    return _make_bench(line, make_twin, lambda link, clock: DynamixelAdapter(made, lambda: link, clock), n_joints)


PROTOCOLS: dict[str, Callable[[int], AdapterBench]] = {
    "canopen": make_canopen,
    "dynamixel": make_dynamixel,
    "mit": make_mit,
    "moteus": make_moteus,
    "odrive": make_odrive,
}


def make_bench(protocol: str, n_joints: int = 1) -> AdapterBench:
    """The bench of a protocol, one of `PROTOCOLS`."""
    return PROTOCOLS[protocol](n_joints)
