"""Motion that contradicts itself trips the gate within 50 ms; slow motion, standstill and reversals never do."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import pytest

from fricomp.control import JointLimits, SafetyGate
from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback

MS = 1_000_000
LIMITS = JointLimits(5.0, 1e6, 10.0, (-3.0, 3.0))
INERTIA = 0.1


class State(NamedTuple):
    """Of one joint, as its drive reports it."""

    position: float
    velocity: float


Lie = Callable[[list[State]], State]
"""What is reported, made of all true states since the lie began, the newest last."""


class Bench:
    """A gate that sees a joint every period [s]; the encoder's step [rad], and the lag of the velocity [s]."""

    def __init__(
        self,
        period: float = 1e-3,
        step: float = 2.4e-5,
        lag: float = 0.005,
        stale_after: float = 0.02,
        breakaway: float | None = None,
    ) -> None:
        self.period, self.step, self.lag = period, step, lag
        self.gate = SafetyGate(
            [replace(LIMITS, breakaway=breakaway)],
            period=period,
            ramp_time=0.0,
            stale_after=stale_after,
            quanta=[(step, step / (period + lag))],
        )
        self.now, self.velocity, self.before = 1_000 * MS, 0.0, 0.0
        self.gate.arm(self.now)
        self.feedback, self.sent = JointFeedback(1), [0.0]

    def sensed(self, position: float) -> State:
        """The encoder's count, and the filtered difference of counts."""
        counted = round(position / self.step) * self.step
        gain = 1.0 - math.exp(-self.period / self.lag) if self.lag else 1.0
        self.velocity += gain * ((counted - self.before) / self.period - self.velocity)
        self.before = counted
        return State(counted, self.velocity)

    def tick(self, state: State, torque: float) -> bool:
        """One cycle; whether the gate is open after it."""
        self.now += round(self.period * 1e9)
        self.feedback.time_ns = self.now
        self.feedback.position[0], self.feedback.velocity[0] = state
        self.gate.observe(self.feedback, self.now)
        return self.gate.admit([torque], self.sent, self.now)


def pushed(bench: Bench, torque: float) -> Iterator[State]:
    """True states of a joint under a torque, friction aside."""
    position = velocity = 0.0
    while True:
        velocity += torque / INERTIA * bench.period
        position += velocity * bench.period
        yield State(position, velocity)


def sine(bench: Bench, amplitude: float, frequency: float) -> Iterator[float]:
    """Positions of a joint that goes to and fro."""
    tick = 0
    while True:
        tick += 1
        yield amplitude * math.sin(2.0 * math.pi * frequency * tick * bench.period)


@pytest.mark.parametrize("period", [1e-3, 5e-3])
@pytest.mark.parametrize("step", [2.4e-5, 1.534e-3])
@pytest.mark.parametrize(("amplitude", "frequency"), [(0.2, 0.02), (0.3, 1.0), (0.05, 5.0), (0.3, 4.0)])
def test_slow_and_fast_motion_with_reversals_is_well(
    period: float, step: float, amplitude: float, frequency: float
) -> None:
    bench = Bench(period, step)
    for position, _ in zip(sine(bench, amplitude, frequency), range(20_000), strict=False):
        assert bench.tick(bench.sensed(position), 0.3 * LIMITS.torque), bench.gate.trip_record


@pytest.mark.parametrize("noise", [0.0, 1.0, 3.0])
def test_a_joint_at_rest_whose_encoder_flickers_is_well(noise: float) -> None:
    bench, rng = Bench(), random.Random(2)
    for _ in range(50_000):
        assert bench.tick(bench.sensed(rng.gauss(0.0, noise * bench.step)), 0.45 * LIMITS.torque)


def test_a_joint_that_sticks_below_its_breakaway_torque_and_breaks_away_is_well() -> None:
    bench, position, velocity = Bench(), 0.0, 0.0
    for tick in range(20_000):
        torque = 0.49 * LIMITS.torque * math.sin(2.0 * math.pi * 1.0 * tick * bench.period)
        held = abs(torque) < 0.4 * LIMITS.torque and abs(velocity) < 0.01
        velocity = 0.0 if held else velocity + (torque - math.copysign(1.9, velocity or torque)) / INERTIA * 1e-3
        position += velocity * 1e-3
        assert bench.tick(bench.sensed(position), torque), bench.gate.trip_record


def test_a_hard_stop_and_a_start_at_full_torque_are_well() -> None:
    bench, position, velocity = Bench(), 0.0, 0.0
    for tick in range(300):
        torque = LIMITS.torque if tick % 100 < 50 else -LIMITS.torque
        velocity += torque / INERTIA * bench.period
        position += velocity * bench.period
        assert bench.tick(bench.sensed(position), torque), bench.gate.trip_record


def test_states_that_come_late_and_unevenly_are_well() -> None:
    bench, rng = Bench(stale_after=0.05), random.Random(3)
    for position, _ in zip(sine(bench, 0.3, 1.0), range(20_000), strict=False):
        state = bench.sensed(position)
        if rng.random() < 0.9:  # a state is lost, now and then several
            assert bench.tick(state, 0.0), bench.gate.trip_record
        else:
            bench.now += round(bench.period * 1e9)


LIES: dict[str, tuple[Lie, str]] = {
    "both frozen": (lambda seen: seen[0], "contradiction"),
    "position frozen": (lambda seen: State(seen[0].position, seen[-1].velocity), "contradiction"),
    "velocity silent": (lambda seen: State(seen[-1].position, 0.0), "contradiction"),
    "velocity mirrored": (lambda seen: State(seen[-1].position, -seen[-1].velocity), "contradiction"),
    "jump": (lambda seen: State(seen[-1].position + 0.5, seen[-1].velocity), "jump"),
    "a jump back and forth": (
        lambda seen: State(seen[-1].position + 0.5 * (len(seen) == 4), seen[-1].velocity),
        "jump",
    ),
}


@pytest.mark.parametrize("period", [1e-3, 5e-3])
@pytest.mark.parametrize("step", [2.4e-5, 1.534e-3])
@pytest.mark.parametrize("lie", LIES)
def test_a_sensor_that_lies_in_motion_stops_the_joint_within_50_ms(lie: str, step: float, period: float) -> None:
    bench = Bench(period, step)
    tell, reason = LIES[lie]
    true = pushed(bench, 2.0)
    for _ in range(round(0.1 / period)):
        assert bench.tick(bench.sensed(next(true).position), 2.0)
    seen: list[State] = []
    while bench.gate.armed:
        seen.append(bench.sensed(next(true).position))
        bench.tick(tell(seen), 2.0)
        assert len(seen) * period <= 0.05
    assert bench.gate.trip_record is not None
    assert bench.gate.trip_record.reason == reason
    assert bench.sent == [0.0]


def test_a_velocity_that_stands_while_the_joint_gains_speed_is_found_once_it_has_come_apart() -> None:
    bench = Bench()
    true = pushed(bench, 2.0)
    for _ in range(100):
        assert bench.tick(bench.sensed(next(true).position), 2.0)
    frozen, ticks = bench.velocity, 0
    while bench.tick(State(bench.sensed(next(true).position).position, frozen), 2.0):
        ticks += 1
    assert ticks < 150  # 20 rad/s² makes a difference of 3 rad/s in that time
    assert bench.gate.trip_record is not None
    assert bench.gate.trip_record.reason == "contradiction"


@pytest.mark.parametrize("load", [0.0, 2.0])
def test_a_sensor_that_is_frozen_from_rest_stops_a_joint_that_friction_cannot_hold_within_50_ms(load: float) -> None:
    bench = Bench(breakaway=1.0)
    for tick in range(200):  # a load that friction holds, or not even that
        assert bench.tick(State(0.0, 0.0), load + 0.9 * math.sin(0.1 * tick))
    ticks = 0
    while bench.tick(State(0.0, 0.0), load + 2.0):
        ticks += 1
    assert ticks <= 50
    assert bench.gate.trip_record is not None
    assert bench.gate.trip_record.reason == "frozen"


def test_a_mirrored_sensor_stops_the_joint_that_runs_away_in_its_loop() -> None:
    bench, position, velocity = Bench(), 0.0, 0.0
    stiffness, damping, reference, torque = 100.0, 6.0, 0.01, 0.0
    while True:
        velocity += torque / INERTIA * bench.period
        position += velocity * bench.period
        shown = bench.sensed(-position)
        torque = max(-5.0, min(5.0, stiffness * (reference - shown.position) - damping * shown.velocity))
        if not bench.tick(shown, torque):
            break
    assert bench.gate.trip_record is not None
    assert bench.gate.trip_record.reason == "runaway"
    assert position < 0.25  # far from the end of the range, at 3 rad


def test_braking_hard_against_the_motion_is_no_runaway() -> None:
    bench, position, velocity = Bench(), 0.0, 6.0
    bench.velocity = velocity
    for _ in range(100):
        velocity -= LIMITS.torque / INERTIA * bench.period
        position += velocity * bench.period
        assert bench.tick(bench.sensed(position), -LIMITS.torque), bench.gate.trip_record


def test_arming_again_forgets_where_the_joint_was() -> None:
    bench = Bench()
    for _ in range(20):
        assert bench.tick(State(0.0, 0.0), 0.0)
    bench.gate.disarm()
    bench.gate.arm(bench.now)
    assert bench.tick(State(1.0, 0.0), 0.0)


def test_what_is_not_finite_is_told_before_anything_else() -> None:
    bench = Bench()
    for _ in range(20):
        bench.tick(State(0.0, 0.0), 0.0)
    assert not bench.tick(State(math.nan, 0.0), 0.0)
    assert bench.gate.trip_record is not None
    assert bench.gate.trip_record.reason == "not_finite"


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, True, "x", 10**400])
def test_a_breakaway_limit_that_is_no_positive_number_is_refused(value: object) -> None:
    with pytest.raises(ParameterError, match="breakaway"):
        JointLimits(5.0, 100.0, 10.0, breakaway=value)  # type: ignore[arg-type]
