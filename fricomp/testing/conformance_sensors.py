"""Sensors that lie: what contradicts itself stops all joints in time; slow motion, standstill and reversals do not."""

from collections.abc import Callable, Iterable
from math import cos, pi, sin
from typing import NamedTuple

import pytest

from fricomp.testing.rig import AdapterRig
from fricomp.testing.steps import cycle, n_joints, opened, start, stopped

__all__ = ["SensorConformance"]

SPEED = 3.0
"""Of the joint as its sensor begins to lie [rad/s]: coarse encoders tell it from rest within `WANTED`."""
TOLD = 0.1
"""Time of honest motion before [s]."""
WANTED = 0.05
"""Time within which the lie must have stopped the joints [s]."""


class _Reading(NamedTuple):
    """Of one joint: position [rad] and velocity [rad/s]."""

    position: float
    velocity: float


_Lie = Callable[[_Reading, _Reading], _Reading]

LIES: dict[str, _Lie] = {
    "frozen": lambda first, true: first,
    "position frozen": lambda first, true: _Reading(first.position, true.velocity),
    "velocity silent": lambda first, true: _Reading(true.position, 0.0),
    "velocity mirrored": lambda first, true: _Reading(true.position, -true.velocity),
    "position mirrored": lambda first, true: _Reading(2.0 * first.position - true.position, true.velocity),
    "jump": lambda first, true: _Reading(true.position + 0.5, true.velocity),
}
"""What is told, of the reading as the lie began and the true one."""

HEALTHY: dict[str, Callable[[float], _Reading]] = {
    "standstill": lambda time: _Reading(0.1, 0.0),
    "slow motion": lambda time: _Reading(0.02 * time, 0.02),
    "reversals": lambda time: _Reading(0.3 * sin(4.0 * pi * time), 1.2 * pi * cos(4.0 * pi * time)),
}
"""Motions that nothing may stop, over time [s]."""


class SensorConformance:
    """Part of `fricomp.testing.conformance.AdapterConformance`."""

    @pytest.mark.parametrize("lie", LIES)
    def test_motion_that_contradicts_itself_stops_all_joints_in_time(self, rig: AdapterRig, lie: str) -> None:
        opened(rig)
        first = _Reading(-0.5, SPEED)
        _move(rig, first)
        start(rig)
        told, wanted = round(TOLD / rig.period), round(WANTED / rig.period)
        honest = [_Reading(first.position + SPEED * n * rig.period, SPEED) for n in range(told + wanted + 1)]
        assert _run(rig, honest[:told]) == told
        tell = LIES[lie]
        assert _run(rig, (tell(honest[told], true) for true in honest[told:])) <= wanted
        assert not rig.adapter.enabled
        rig.clock.advance(rig.period)
        assert stopped(rig)

    @pytest.mark.parametrize("motion", HEALTHY)
    def test_healthy_motion_is_not_stopped(self, rig: AdapterRig, motion: str) -> None:
        opened(rig)
        position = HEALTHY[motion]
        _move(rig, position(0.0))
        start(rig)
        readings = [position(n * rig.period) for n in range(1000)]
        assert _run(rig, readings) == len(readings), rig.adapter.gate.trip_record


def _move(rig: AdapterRig, reading: _Reading) -> None:
    rig.move(0, *reading)


def _run(rig: AdapterRig, readings: Iterable[_Reading]) -> int:
    """Cycles with half the torque until one is refused; how many were sent."""
    for sent, reading in enumerate(readings):
        _move(rig, reading)
        if not cycle(rig, [0.5 * rig.torque_limit] * n_joints(rig)):
            return sent
    return sent + 1
