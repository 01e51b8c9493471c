"""The safety gate: no torque beyond the limits, no way past a trip."""

from __future__ import annotations

import math
import sys
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricomp.control import JointLimits, SafetyGate
from fricomp.control.gate.gate import ABSURD_TORQUE_RATIO
from fricomp.control.gate.trip import TripRecord
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


@pytest.mark.parametrize("now", [9, 8])
def test_a_clock_that_stands_or_goes_back_changes_no_torque(now: int) -> None:
    gate, out = make_gate(), [0.0, 0.0]
    for k in range(2, 10):
        gate.admit([5.0, 1.0], out, k * MS)
    before = list(out)
    assert gate.admit([-5.0, -1.0], out, now * MS)
    assert out == before


def test_half_a_period_allows_half_a_step_and_two_periods_one() -> None:
    gate, out = make_gate(), [0.0, 0.0]
    assert gate.admit([5.0, 1.0], out, 2 * MS)
    assert out == pytest.approx([1.0, 0.05])
    assert gate.admit([5.0, 1.0], out, 5 * MS // 2)
    assert out == pytest.approx([1.5, 0.075])
    assert gate.admit([-5.0, -1.0], out, 9 * MS // 2)
    assert out == pytest.approx([0.5, 0.025])


def test_half_of_the_ramp_lets_half_of_the_clamped_torque_through() -> None:
    gate, out = SafetyGate([JointLimits(10.0, 1e9, 5.0)], period=1e-3, ramp_time=0.01), [0.0]
    gate.arm(MS)
    for now, torque in ((1, 0.0), (6, 5.0), (11, 10.0), (20, 10.0)):
        assert gate.admit([30.0], out, now * MS)
        assert out == pytest.approx([torque])
    gate.admit([-30.0], out, 21 * MS)
    assert out == pytest.approx([-10.0])


def test_what_stands_exactly_at_a_limit_is_within_it() -> None:
    gate, feedback, out = make_gate(), well(2 * MS), [0.0, 0.0]
    for sign in (1.0, -1.0):
        feedback.position[:], feedback.velocity[:], feedback.temperature[:] = (
            [3.0 * sign, 9e9],
            [5.0 * sign, -sign],
            [80.0, 99.0],
        )
        gate.arm(2 * MS)
        assert gate.observe(feedback, 2 * MS)
    assert gate.admit([1000.0, -200.0], out, 2 * MS), "exactly a hundred times the limits"
    assert gate.admit([0.0, 0.0], out, 22 * MS), "data that are as old as they may be"


@pytest.mark.parametrize(
    ("reason", "name", "values"),
    [
        ("overspeed", "velocity", [5.1, 1.1]),
        ("position_limit", "position", [-3.1, 0.0]),
        ("overtemperature", "temperature", [80.1, 80.1]),
        ("drive_fault", "fault", [7, 7]),
        ("not_finite", "position", [math.nan, math.nan]),
    ],
)
def test_joints_that_are_all_outside_their_limits_trip_as_one_does(reason: str, name: str, values: list[float]) -> None:
    one, both, alone = make_gate(), make_gate(), SafetyGate(LIMITS[:1], period=1e-3)
    for gate, n in ((both, 2), (alone, 1), (one, 1)):
        feedback = JointFeedback(len(gate.limits))
        feedback.time_ns, feedback.position[:], feedback.velocity[:] = (
            2 * MS,
            [0.0] * len(gate.limits),
            [0.0] * len(gate.limits),
        )
        feedback.temperature[:] = [20.0] * len(gate.limits)
        assert gate.observe(feedback, 2 * MS)
        getattr(feedback, name)[:n] = values[:n]
        assert not gate.observe(feedback, 2 * MS)
        assert gate.trip_record is not None
        assert gate.trip_record.reason == reason


@pytest.mark.parametrize("name", ["velocity", "position"])
def test_the_joint_that_is_outside_is_named_and_not_one_at_its_limit(name: str) -> None:
    gate, feedback = SafetyGate([LIMITS[0], LIMITS[0]], period=1e-3), well(2 * MS)
    feedback.position[:], feedback.velocity[:] = [3.0, 0.0], [-5.0, 0.0]
    getattr(feedback, name)[1] = 6.0
    assert not gate.observe(feedback, 2 * MS)
    assert gate.trip_record is not None
    assert "joint 1 " in gate.trip_record.detail


def test_a_joint_is_told_of_by_its_name_where_it_has_one() -> None:
    gate, feedback = SafetyGate(LIMITS, period=1e-3, names=["shoulder", "elbow"][: len(LIMITS)]), well(2 * MS)
    feedback.velocity[0] = 1e3
    assert not gate.observe(feedback, 2 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.detail.startswith("shoulder moves at 1000")
    with pytest.raises(ParameterError, match="3 names given"):
        SafetyGate(LIMITS, period=1e-3, names=["a", "b", "c"])


def test_torques_of_another_number_of_joints_are_refused_where_they_are_watched() -> None:
    gate, feedback = SafetyGate(LIMITS, period=1e-3, watch_torque=True), well(2 * MS)
    feedback.torque = [0.0]
    assert not gate.observe(feedback, 2 * MS)


@pytest.mark.parametrize("name", ["position", "velocity", "temperature"])
def test_a_state_of_another_number_of_joints_is_refused(name: str) -> None:
    gate, feedback = make_gate(), well(2 * MS)
    setattr(feedback, name, [0.0, 0.0, 0.0])
    assert not gate.observe(feedback, 2 * MS)
    assert gate.trip_record is not None
    assert gate.trip_record.reason == "not_finite"


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        ([1.0], "wrong_joint_count"),
        ([math.nan, 1.0], "not_finite"),
        ([1.0, -math.inf], "not_finite"),
        ([1.0, 201.0], "absurd_command"),
    ],
)
def test_a_refused_command_names_its_reason_once_the_gate_is_armed(command: list[float], reason: str) -> None:
    closed, gate, out = SafetyGate(LIMITS, period=1e-3), make_gate(), [9.0, 9.0]
    assert not closed.admit(command, out, 2 * MS)
    assert (closed.trip_record, out) == (None, [0.0, 0.0])
    assert not gate.admit(command, out, 2 * MS)
    assert gate.trip_record is not None
    assert (gate.trip_record.reason, gate.trip_record.time_ns) == (reason, 2 * MS)


def test_an_age_and_its_limit_are_told_in_milliseconds() -> None:
    gate = make_gate()
    gate.admit([0.0, 0.0], [0.0, 0.0], 22 * MS)
    assert str(gate.trip_record) == "stale: the data of the joints is 21.0 ms old, limit 20.0 ms"


def test_a_temperature_may_be_unknown_for_one_second_after_arming() -> None:
    gate = make_gate()
    assert gate.observe(well(1001 * MS), 1001 * MS)
    assert not gate.observe(well(1001 * MS + 1), 1001 * MS + 1)


def test_three_states_in_a_row_of_more_than_a_quarter_too_much_trip_and_arming_counts_anew() -> None:
    gate, state = SafetyGate(LIMITS, period=1e-3, watch_torque=True), well(2 * MS)
    state.temperature[:] = [20.0, 20.0]
    state.torque[:] = [12.5, 2.5]
    assert all(gate.observe(state, 2 * MS) for _ in range(4)), "a quarter too much is not more than that"
    state.torque[:] = [12.6, 0.0]
    for _ in range(2):
        assert [gate.observe(state, 2 * MS) for _ in range(2)] == [True, True]
        gate.arm(2 * MS)
    assert [gate.observe(state, 2 * MS) for _ in range(3)] == [True, True, False]


def test_a_gate_says_what_it_is() -> None:
    gate, out = SafetyGate(LIMITS, period=1e-3, ramp_time=0.0), [0.0, 0.0]
    assert (gate.armed, gate.tripped, gate.trip_record, gate.last_trip, list(gate.admitted)) == (
        False, False, None, None, [0.0, 0.0],
    )  # fmt: skip
    gate.arm(MS)
    gate.admit([0.5, 0.02], out, 2 * MS)
    assert (gate.armed, gate.tripped, list(gate.admitted)) == (True, False, [0.5, 0.02])
    gate.disarm()
    assert (gate.armed, list(gate.admitted)) == (False, [0.0, 0.0])
    gate.trip("stop", "test", 3 * MS)
    gate.trip("link", "later", 4 * MS)
    expected = TripRecord("stop", "test", 3 * MS)
    assert (gate.armed, gate.tripped, gate.trip_record, gate.last_trip) == (False, True, expected, expected)
    with pytest.raises(SafetyTrip, match="stop: test; find the cause"):
        gate.raise_if_tripped()
    gate.reset()
    gate.raise_if_tripped()
    assert (gate.armed, gate.tripped, gate.trip_record, gate.last_trip) == (False, False, None, expected)


@pytest.mark.parametrize("limits", [[], None, [1.0], [*LIMITS, None], iter(LIMITS)])
def test_a_gate_needs_limits_of_joints(limits: Any) -> None:
    with pytest.raises(ParameterError, match="at least one joint"):
        SafetyGate(limits, period=1e-3)


@pytest.mark.parametrize("name", ["period", "ramp_time", "stale_after"])
def test_times_are_from_a_nanosecond_to_eleven_days(name: str) -> None:
    def make(value: Any) -> SafetyGate:
        times: dict[str, Any] = {"period": 1e-3, name: value}
        return SafetyGate(LIMITS, **times)

    assert not any(make(value).tripped for value in (1e-9, 1e6))
    for bad in (math.nan, -1.0, 1e6 + 0.5, math.inf, "1", *(() if name == "ramp_time" else (0.0, 0.9e-9))):
        with pytest.raises(ParameterError, match=name):
            make(bad)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1"])
def test_limits_must_be_finite_and_positive(bad: Any) -> None:
    for name in ("torque", "torque_rate", "velocity"):
        with pytest.raises(ParameterError, match=name):
            JointLimits(**({"torque": 1.0, "torque_rate": 1.0, "velocity": 1.0} | {name: bad}))


def test_breakaway_is_forty_five_hundredths_of_the_torque_or_what_is_given() -> None:
    assert JointLimits(2.0, 1.0, 1.0).breakaway_torque == pytest.approx(0.9)
    given = JointLimits(2, 1, 1, (-1, 1), 0, 3)
    assert given.breakaway_torque == 3.0
    assert [type(value) for value in (given.torque, given.breakaway, *(given.position or ()))] == [float] * 4


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1", True])
def test_a_breakaway_torque_is_finite_and_positive(bad: Any) -> None:
    with pytest.raises(ParameterError, match="breakaway"):
        JointLimits(1.0, 1.0, 1.0, breakaway=bad)


@pytest.mark.parametrize("bad", [math.nan, math.inf, "80", True])
def test_a_temperature_limit_is_finite(bad: Any) -> None:
    with pytest.raises(ParameterError, match="temperature"):
        JointLimits(1.0, 1.0, 1.0, temperature=bad)


@pytest.mark.parametrize("bad", [(1.0, -1.0), (0.0, math.nan), (1.0,), (1.0, 1.0), (0.0, 1.0, 2.0), 3.0, ("0", "1")])
def test_position_limits_must_be_an_ascending_range(bad: Any) -> None:
    with pytest.raises(ParameterError, match="position"):
        JointLimits(1.0, 1.0, 1.0, bad)
