"""The safety gate: no torque beyond the limits, no way past a trip."""

from __future__ import annotations

import math
import sys
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricomp.control import JointLimits, SafetyGate
from fricomp.control.gate.gate import ABSURD_TORQUE_RATIO, TripRecord
from fricomp.errors import ParameterError, SafetyTrip
from fricomp.joint import JointFeedback

MS = 1_000_000
LIMITS = (JointLimits(10.0, 1000.0, 5.0, (-3.0, 3.0), 80.0), JointLimits(2.0, 50.0, 1.0))
sane = st.floats(-100.0, 100.0)
anything = st.one_of(
    st.floats(), st.integers(), st.none(), st.text(max_size=3), st.just(10**400), st.just(1e308), st.complex_numbers()
)


def make_gate(ramp_time: float = 0.0) -> SafetyGate:
    gate = SafetyGate(LIMITS, period=1e-3, ramp_time=ramp_time, stale_after=0.02)
    gate.arm(MS)
    return gate


def well(time_ns: int) -> JointFeedback:
    feedback = JointFeedback(2)
    feedback.time_ns, feedback.position[:], feedback.velocity[:] = time_ns, [0.0, 0.0], [0.0, 0.0]
    return feedback


def is_bad(value: Any, limit: float) -> bool:
    try:
        return not abs(float(value)) <= ABSURD_TORQUE_RATIO * limit
    except (TypeError, ValueError, OverflowError):
        return True


@given(st.lists(st.tuples(sane, sane, st.integers(0, 10 * MS)), max_size=60), st.sampled_from([0.0, 0.05]))
def test_output_never_exceeds_limit_rate_or_ramp(commands: list[tuple[float, float, int]], ramp_time: float) -> None:
    gate, now, before, out = make_gate(ramp_time), MS, [0.0, 0.0], [0.0, 0.0]
    for first, second, wait in commands:
        now += wait
        gate.observe(well(now), now)
        assert gate.admit([first, second], out, now)
        ramp = min(1.0, (now - MS) / (ramp_time * 1e9)) if ramp_time else 1.0
        for tau, last, limit in zip(out, before, LIMITS, strict=True):
            assert abs(tau) <= limit.torque * ramp * (1 + 1e-12)
            assert abs(tau - last) <= limit.torque_rate * min(wait, MS) * 1e-9 * (1 + 1e-9) + 1e-15
        before = list(out)


@given(st.lists(st.tuples(anything, anything), min_size=1, max_size=8))
def test_bad_command_on_any_joint_gives_no_torque_and_latches(commands: list[tuple[Any, Any]]) -> None:
    gate, now, tripped = make_gate(), MS, False
    for command in commands:
        now += MS
        out = [99.0, 99.0]
        gate.observe(well(now), now)
        tripped = tripped or any(is_bad(v, limit.torque) for v, limit in zip(command, LIMITS, strict=True))
        admitted = gate.admit(command, out, now)
        assert admitted is not tripped
        assert gate.tripped is tripped
        assert all(math.isfinite(v) and abs(v) <= limit.torque for v, limit in zip(out, LIMITS, strict=True))
        if tripped:
            assert out == [0.0, 0.0]


@given(st.tuples(anything, anything), st.tuples(anything, anything))
def test_bad_feedback_on_any_joint_latches(position: tuple[Any, Any], velocity: tuple[Any, Any]) -> None:
    gate, feedback, out = make_gate(), well(2 * MS), [9.0, 9.0]
    feedback.position[:], feedback.velocity[:] = position, velocity

    def good(value: Any, low: float, high: float) -> bool:
        return isinstance(value, int | float) and low <= value <= high and abs(value) <= sys.float_info.max

    expected = (
        good(position[0], -3, 3)
        and good(position[1], -sys.float_info.max, sys.float_info.max)
        and good(velocity[0], -5, 5)
        and good(velocity[1], -1, 1)
    )
    assert gate.observe(feedback, 2 * MS) is expected
    assert gate.admit([1.0, 1.0], out, 2 * MS) is expected
    assert expected or out == [0.0, 0.0]


@pytest.mark.parametrize(
    ("reason", "change"),
    [
        ("overspeed", {"velocity": [0.0, -1.01]}),
        ("position_limit", {"position": [3.01, 0.0]}),
        ("overtemperature", {"temperature": [81.0, math.nan]}),
        ("drive_fault", {"fault": [0, 0x7500]}),
        ("not_finite", {"position": [0.0, math.inf]}),
        ("not_finite", {"velocity": [math.nan, 0.0]}),
        ("not_finite", {"position": [0.0]}),
    ],
)
def test_state_outside_its_limits_names_its_reason(reason: str, change: dict[str, list[float]]) -> None:
    gate, feedback = make_gate(), well(2 * MS)
    for name, values in change.items():
        getattr(feedback, name)[:] = values
    assert not gate.observe(feedback, 2 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.reason == reason


def test_old_data_trips_even_if_nobody_observes() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    assert gate.admit([1.0, 1.0], out, 20 * MS)
    assert not gate.admit([1.0, 1.0], out, 22 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.reason == "stale"


def test_no_data_age_while_the_gate_is_not_armed() -> None:
    gate, out, boot = SafetyGate(LIMITS, period=1e-3), [9.0, 9.0], 10**12
    assert not gate.admit([1.0, 1.0], out, boot)
    assert gate.observe(well(0), boot)
    gate.arm(boot)
    gate.disarm()
    assert not gate.admit([1.0, 1.0], out, boot + 50 * MS)
    assert (gate.trip_record, out) == (None, [0.0, 0.0])
    gate.arm(boot + 50 * MS)
    assert gate.admit([1.0, 1.0], out, boot + 51 * MS)


def test_a_temperature_that_stays_unknown_trips_where_it_is_limited() -> None:
    gate = make_gate()
    assert gate.observe(well(1000 * MS), 1000 * MS)
    assert not gate.observe(well(1002 * MS), 1002 * MS)
    assert gate.trip_record is not None
    assert "does not report its temperature" in gate.trip_record.detail


def test_more_torque_than_the_limit_trips_where_drives_close_the_loop() -> None:
    gate = SafetyGate(LIMITS, period=1e-3, watch_torque=True)
    gate.arm(MS)
    state = well(2 * MS)
    state.temperature[:] = [20.0, 20.0]
    reported = [(12.0, 2.4), (1.0, 3.0), (1.0, 3.0), (math.nan, 0.0), (1.0, -3.0), (1.0, 3.0)]
    for k, state.torque[:] in enumerate(reported, start=2):
        state.time_ns = k * MS
        assert gate.observe(state, k * MS)
    state.time_ns = 8 * MS
    assert not gate.observe(state, 8 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.reason == "overtorque"


def test_torque_of_the_host_is_not_judged_by_what_is_reported() -> None:
    gate = make_gate()
    state = well(2 * MS)
    state.torque[:] = [99.0, 99.0]
    assert all(gate.observe(state, 2 * MS) for _ in range(5))


def test_data_from_the_future_trips() -> None:
    gate = make_gate()
    assert not gate.observe(well(100 * MS), 2 * MS)


def test_nothing_but_reset_opens_a_latched_gate() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    gate.trip("drive_fault", "test")
    gate.trip("stop", "later")
    with pytest.raises(SafetyTrip, match="drive fault: test"):
        gate.arm(2 * MS)
    gate.disarm()
    assert not gate.admit([1.0, 1.0], out, 2 * MS)
    gate.reset()
    assert not gate.admit([1.0, 1.0], out, 2 * MS), "a reset gate must stay closed until it is armed"
    gate.arm(3 * MS)
    assert gate.admit([1.0, 1.0], out, 3 * MS)


@pytest.mark.parametrize("when", ["record", "command"])
def test_no_torque_passes_a_trip_that_another_thread_interleaves(when: str, monkeypatch: pytest.MonkeyPatch) -> None:
    gate, out = make_gate(), [0.0, 0.0]
    if when == "record":  # the control thread arms while the trip is half done

        def armed_meanwhile(*given: Any) -> TripRecord:
            gate.arm(MS)
            return TripRecord(*given)

        monkeypatch.setattr("fricomp.control.gate.gate.TripRecord", armed_meanwhile)
        gate.trip("stop", "from another thread")
        assert not gate.armed
    else:  # the trip has left its record and nothing else yet
        gate._record = TripRecord("stop", "from another thread")
    assert gate.tripped
    assert not gate.admit([0.5, 0.5], out, 2 * MS)
    assert out == [0.0, 0.0]


class _TrippedMeanwhile(list[float]):
    """What may be sent, whose filling another thread interrupts by a trip."""

    gate: SafetyGate

    def __setitem__(self, place: Any, value: Any) -> None:
        super().__setitem__(place, value)
        if isinstance(place, slice):
            self.gate.trip("stop", "from another thread")


def test_a_trip_while_a_command_is_let_through_takes_it_back() -> None:
    gate, out = make_gate(), _TrippedMeanwhile([0.0, 0.0])
    out.gate = gate
    assert not gate.admit([0.5, 0.5], out, 2 * MS)
    assert out == [0.0, 0.0]


def test_a_hundred_times_the_limit_is_absurd_and_less_is_clamped() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    assert gate.admit([999.0, 0.0], out, 2 * MS)
    assert not gate.admit([1001.0, 0.0], out, 3 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.reason == "absurd_command"


def test_an_armed_gate_that_is_reset_admits_nothing() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    gate.reset()
    assert not gate.admit([0.5, 0.5], out, 2 * MS)
    assert out == [0.0, 0.0]


def test_wrong_number_of_joints_trips() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    assert not gate.admit([1.0, 1.0, 1.0], out, 2 * MS)
    assert gate.tripped


def test_arming_starts_again_from_zero() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    for k in range(2, 9):
        gate.admit([5.0, 1.0], out, k * MS)
    assert out[0] == 5.0
    gate.disarm()
    gate.arm(9 * MS)
    gate.admit([5.0, 1.0], out, 9 * MS)
    assert out == [0.0, 0.0]


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1"])
def test_limits_must_be_finite_and_positive(bad: Any) -> None:
    for name in ("torque", "torque_rate", "velocity"):
        with pytest.raises(ParameterError, match=name):
            JointLimits(**({"torque": 1.0, "torque_rate": 1.0, "velocity": 1.0} | {name: bad}))


@pytest.mark.parametrize("bad", [(1.0, -1.0), (0.0, math.nan), (1.0,)])
def test_position_limits_must_be_an_ascending_range(bad: Any) -> None:
    with pytest.raises(ParameterError, match="position"):
        JointLimits(1.0, 1.0, 1.0, bad)


def test_gate_needs_a_joint_and_a_period() -> None:
    with pytest.raises(ParameterError, match="at least one joint"):
        SafetyGate([], period=1e-3)
    with pytest.raises(ParameterError, match="period"):
        SafetyGate(LIMITS, period=math.nan)
