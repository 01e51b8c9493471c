"""What a control cycle costs an adapter: encode, gate and decode, without the bus."""

from dataclasses import dataclass
from typing import Any

from fricomp.joint import JointCommand, JointFeedback

from ..latency.unit import time_beside_unit
from .bench import AdapterBench, make_bench

__all__ = ["LARGEST_COST", "CycleCost", "measure_cost"]

LARGEST_COST = 25.0
"""A cycle may cost this many bare Stribeck curves a joint [1]."""

_REPEATS = 9


@dataclass(frozen=True)
class CycleCost:
    """Cost of one control cycle.

    Attributes:
        protocol: Which.
        n_joints: On one bus.
        seconds: Of write and read together, a joint [s].
        units: Median over the repeats of its ratio to the bare Stribeck curve timed beside it [1].
    """

    protocol: str
    n_joints: int
    seconds: float
    units: float


class EchoLink:
    """Takes everything and answers the same states every time."""

    def __init__(self, states: Any) -> None:
        self._states = states

    def send(self, traffic: Any) -> None:
        """Forget it."""

    def receive(self) -> Any:
        """The states of all joints."""
        return self._states

    def discard_output(self) -> None:
        """Nothing waits."""

    def close(self) -> None:
        """Nothing is held."""


def measure_cost(protocol: str, n_joints: int, cycles: int) -> CycleCost:
    """Time `cycles` of write and read of an enabled adapter, its states prepared beforehand."""
    bench = make_bench(protocol, n_joints)
    bench.start()
    command, feedback = JointCommand(n_joints), JointFeedback(n_joints)
    link: Any = EchoLink(_capture_states(bench, command, feedback))
    bench.adapter._link = link  # type: ignore[attr-defined]
    adapter = bench.adapter

    def cycle() -> None:
        adapter.write(command)
        adapter.read_into(feedback)

    cycle()
    if not adapter.enabled:
        raise AssertionError(f"{protocol}: {adapter.gate.trip_record}")
    seconds, units = time_beside_unit(cycle, cycles, _REPEATS)
    return CycleCost(protocol, n_joints, seconds / n_joints, units / n_joints)


def _capture_states(bench: AdapterBench, command: JointCommand, feedback: JointFeedback) -> Any:
    """What the drives answer to one command."""
    for _ in range(3):
        bench.adapter.write(command)
        bench.clock.advance(0.005)
        bench.adapter.read_into(feedback)
    bench.adapter.write(command)
    return bench.link.receive()
