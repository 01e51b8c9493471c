"""Positions whose 32 bits on the wire come to their end: the joint goes on, and so does its position."""

from __future__ import annotations

from math import tau
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fricomp.adapters.wrapping import CountUnwrapper, wrap_count
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.studies.adapters.bench import PERIOD, AdapterBench, make_bench
from tests.adapters.canopen.rig import CanOpenRig
from tests.adapters.peers.cia402 import I32, RECORDS

END = 1 << 31
COUNTS_A_TURN = {"canopen": 2**18, "dynamixel": 4096}  # of the twins


FAR = 1 << 29  # no joint moves by so much between two states


@given(st.integers(-(2**40), 2**40), st.lists(st.integers(-FAR, FAR), max_size=20))
def test_a_position_goes_on_over_both_ends(start: int, steps: list[int]) -> None:
    turns, at = CountUnwrapper(), start
    first = turns.unwrap(wrap_count(at))
    assert first == wrap_count(start)
    for step in steps:
        at += step
        assert turns.unwrap(wrap_count(at)) - first == at - start


@given(st.integers(-(2**31), 2**31 - 1), st.lists(st.integers(-(2**31), 2**31 - 1), max_size=6))
@example(100, [1_200_000_000, -1_200_000_000])
def test_damaged_positions_leave_none_behind_them(at: int, damaged: list[int]) -> None:
    turns = CountUnwrapper()
    assert [turns.unwrap(at), turns.unwrap(at)] == [at, at]
    for count in damaged:
        if abs(wrap_count(count - at)) > FAR:  # a nearer one is a motion, which goes on from there
            turns.unwrap(count)
    assert turns.unwrap(at) == at


def test_a_first_position_that_is_damaged_leaves_none_behind_it() -> None:
    turns = CountUnwrapper()
    turns.unwrap(-2_000_000_000)
    assert turns.unwrap(1_500_000_000) == 1_500_000_000
    assert turns.unwrap(1_500_000_001) == 1_500_000_001


def bench_at_the_end(protocol: str, monkeypatch: pytest.MonkeyPatch) -> AdapterBench:
    """A joint that stands ten counts before the end of the wire's range."""
    limits: dict[str, Any] = {"torque": 2.0, "torque_rate": 1e9, "velocity": 8.0, "breakaway": 1e3}
    monkeypatch.setattr("fricomp.sim_bench.studies.adapters.bench.LIMITS", limits)
    bench = make_bench(protocol)
    if protocol == "dynamixel":  # whose counts begin within one turn where it is switched on
        servo = bench.twin.drives[0]
        servo._turns = -(END // 4096)
        bench.axes[0].position = -10 * tau / 4096
    else:
        bench.axes[0].position = (END - 10) * tau / COUNTS_A_TURN[protocol]
    return bench


@pytest.mark.parametrize("protocol", sorted(COUNTS_A_TURN))
def test_an_adapter_reports_no_jump_where_the_wire_has_one(protocol: str, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_at_the_end(protocol, monkeypatch)
    count = tau / COUNTS_A_TURN[protocol]
    bench.start()
    bench.axes[0].velocity = count / PERIOD
    command, feedback = JointCommand(1), JointFeedback(1)
    for number in range(20):
        assert bench.adapter.write(command)
        bench.clock.advance(PERIOD)
        bench.adapter.read_into(feedback)
        assert feedback.position[0] == pytest.approx((END - 10 + number) * count, abs=0.6 * count)
        bench.axes[0].position += count
    assert not bench.adapter.gate.tripped


def test_a_position_command_beyond_the_end_is_the_nearest_one(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_at_the_end("canopen", monkeypatch)
    references: list[float] = []
    bench.axes[0].command = lambda torque, velocity=0.0, position=0.0: references.append(position)  # type: ignore[method-assign]
    bench.adapter.open()
    bench.adapter.configure("position", PERIOD)
    bench.adapter.enable()
    command, count = JointCommand(1), tau / COUNTS_A_TURN["canopen"]
    for number in range(20):
        command.position[0] = (END - 10 + number) * count
        assert bench.adapter.write(command)
        bench.clock.advance(PERIOD)
        bench.adapter.read_into(JointFeedback(1))
    assert references[-1] == pytest.approx((-END + 9) * count, rel=1e-12)


def test_a_servo_too_far_from_zero_for_its_position_mode_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_at_the_end("dynamixel", monkeypatch)
    bench.adapter.open()
    bench.adapter.configure("position", PERIOD)
    with pytest.raises(AdapterError, match="stands 524288 turns from its zero, and its position mode reaches 256"):
        bench.adapter.enable()
    assert not bench.axes[0].energised


@pytest.mark.parametrize(("low", "high"), [(-1000, 999), (0, 360_000)])
def test_a_drive_that_lets_its_position_begin_again_is_refused_by_name(
    low: int, high: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RECORDS, 0x607B, [(I32, low), (I32, high)])
    with pytest.raises(AdapterConfigurationError, match=rf"joint 'joint 0'.*within {low} to {high} counts \(607B\)"):
        CanOpenRig().adapter.open()


@pytest.mark.parametrize(("low", "high"), [(0, 0), (-END, END - 1)])
def test_a_range_of_positions_that_is_whole_or_off_is_none(
    low: int, high: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RECORDS, 0x607B, [(I32, low), (I32, high)])
    CanOpenRig().adapter.open()
