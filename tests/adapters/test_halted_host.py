"""A host that is halted between noting the time of a request and sending it: its joint has not jumped."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sin
from typing import Any

import pytest

from fricomp.adapters import adapter_class
from fricomp.joint import JointCommand, JointFeedback, await_feedback
from fricomp.sim_bench.studies.adapters.bench import PROTOCOLS

STALE_AFTER = 0.2  # as a twin's configuration has it [s]
STIFFNESS, DAMPING = 98.7, 6.3  # of a loop of 5 Hz on the default joint's 0.1 kg·m²


class HaltedLink:
    """A link before which the process is halted once, while the drives go on."""

    def __init__(self, link: Any, clock: Any) -> None:
        self._link, self._clock = link, clock
        self.halt = 0.0  # of the next frames [s]

    def send(self, content: Any) -> None:
        halt, self.halt = self.halt, 0.0
        self._clock.sleep_until(self._clock.now_ns() + round(halt * 1e9))
        self._link.send(content)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._link, name)


class MovingJoint:
    """A joint that swings with up to 1.9 rad/s behind an adapter and its twin.

    Args:
        protocol: Of the twin.
        period: Of the loop [s].
    """

    def __init__(self, protocol: str, period: float) -> None:
        made: Any = adapter_class(f"twin-{protocol}")
        self.adapter, self.period, self.ticks = made.from_configuration({}), period, 0
        self.link = HaltedLink(self.adapter._open_link(), self.adapter.clock)
        self.adapter._open_link = lambda: self.link
        self.adapter.open()
        self.adapter.options = replace(self.adapter.options, stale_after=STALE_AFTER)
        self.adapter.configure("torque", period)
        self.feedback, self.command = JointFeedback(1), JointCommand(1)
        await_feedback(self.adapter, self.feedback, period)
        self.adapter.enable()

    def tick(self) -> bool:
        """One cycle of the loop; whether new data have come."""
        self.ticks += 1
        most = 0.9 * self.adapter.options.limits[0].torque
        wanted = 0.6 * sin(pi * self.ticks * self.period) - self.feedback.position[0]
        torque = STIFFNESS * wanted - DAMPING * self.feedback.velocity[0]
        self.command.torque[0] = max(-most, min(most, torque))
        assert self.adapter.write(self.command), self.adapter.gate.trip_record
        clock = self.adapter.clock
        clock.sleep_until(clock.now_ns() + round(self.period * 1e9))
        return bool(self.adapter.read_into(self.feedback))


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize(("halt", "period"), [(0.05, 2.5e-3), (0.07, 1e-3)])
def test_a_halt_on_the_way_of_a_request_is_no_jump(protocol: str, halt: float, period: float) -> None:
    joint = MovingJoint(protocol, period)
    halts = 0
    while halts < 6:
        joint.tick()
        if joint.ticks % 61 == 0 and abs(joint.feedback.velocity[0]) > 1.0:
            joint.link.halt = halt
            halts += 1
    joint.tick()
    assert joint.adapter.enabled, joint.adapter.gate.trip_record
    joint.adapter.close()


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_bus_that_is_always_slow_keeps_its_data(protocol: str) -> None:
    joint = MovingJoint(protocol, 0.02)
    fresh = 0
    for _ in range(40):
        joint.link.halt = 0.006
        fresh += joint.tick()
    assert fresh >= 18
    joint.adapter.close()
