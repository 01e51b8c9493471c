"""What a caller does with an adapter, its gate or a loop leaves no torque on and opens no latch."""

from __future__ import annotations

from math import nan

import pytest

from fricomp.control import ControlLoop, PositionController, SineReference
from fricomp.errors import AdapterError, ParameterError, SafetyTrip
from tests.adapters.fake_driver import PERIOD, FakeAdapter, command, enabled_adapter


def make_loop(adapter: FakeAdapter) -> ControlLoop:
    return ControlLoop(adapter, SineReference([0.1], 1.0, [0.5]), PositionController([1.0], [0.1], [0.01]))


@pytest.mark.parametrize(("duration", "why"), [(0.1, "the joints are enabled"), (nan, "duration")])
def test_a_loop_that_cannot_begin_stops_joints_that_were_enabled_before(duration: float, why: str) -> None:
    adapter = enabled_adapter()
    adapter.write(command(torque=1.0))
    with pytest.raises((AdapterError, ParameterError), match=why):
        make_loop(adapter).run(duration)
    assert adapter.log[-1] == "stop"
    assert not adapter.enabled


def test_a_loop_that_cannot_begin_tells_of_a_stop_that_did_not_get_through() -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = AdapterError("the bus is silent")
    with pytest.raises(AdapterError, match=r"the joints are enabled.*did not reach the drive.*cut the power"):
        make_loop(adapter).run(0.1)


@pytest.mark.parametrize("trip", ["stop", "overspeed"])
def test_a_gate_that_a_caller_resets_releases_nothing(trip: str) -> None:
    adapter = enabled_adapter()
    if trip == "stop":
        adapter.safe_stop("emergency button")
    else:
        adapter.gate.trip("overspeed", "emergency button")
        adapter.write(command())
    adapter.gate.reset()
    with pytest.raises(AdapterError, match="emergency button"):
        adapter.configure("torque", PERIOD)
    adapter.gate.reset()
    with pytest.raises(SafetyTrip, match=r"emergency button.*clear_faults"):
        adapter.enable()
    assert not adapter.enabled
    adapter.clear_faults()
    adapter.enable()


def test_a_trip_that_is_reset_before_the_next_command_still_stops_the_joints() -> None:
    adapter = enabled_adapter()
    adapter.gate.trip("overrun", "15 cycles missed")
    adapter.gate.reset()
    adapter.gate.arm(adapter.manual_clock.now_ns())
    assert not adapter.write(command(torque=1.0))
    assert (adapter.sent, adapter.log[-1], adapter.enabled) == ([], "stop", False)
