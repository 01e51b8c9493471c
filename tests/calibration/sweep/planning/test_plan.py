"""Speeds, profiles and plans."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fricomp.calibration.sweep import SweepSettings, plan_plateaus
from fricomp.calibration.sweep.planning.plan import (
    Travel,
    default_speeds,
    first_again,
    plan_velocities,
    top_speed,
    travel_of,
)
from fricomp.calibration.sweep.planning.profile import move_profile
from fricomp.calibration.sweep.planning.speed import dense_around, parse_speeds
from fricomp.errors import ParameterError
from fricomp.joint import JointCapabilities

TRAVEL = Travel(-2.0, 2.0, 8.0, quantum=2.4e-5)


def test_speeds_are_read_from_words() -> None:
    assert parse_speeds("log:0.01:1:3") == pytest.approx([0.01, 0.1, 1.0])
    assert parse_speeds("uniform:1:3:3") == pytest.approx([1.0, 2.0, 3.0])
    assert parse_speeds("0.5, 0.1") == pytest.approx([0.1, 0.5])


@pytest.mark.parametrize("words", ["", "log:1:0.1:5", "log:1:2", "0.1,-2", "fast", "0.1,nan"])
def test_speeds_that_make_no_sense_are_refused(words: str) -> None:
    with pytest.raises(ParameterError):
        parse_speeds(words)


def test_dense_speeds_enclose_the_stribeck_velocity() -> None:
    speeds = dense_around(0.05, 8)
    assert speeds[0] < 0.5 * 0.05
    assert speeds[-1] > 2.0 * 0.05


@given(st.floats(-3.0, 3.0), st.floats(0.01, 5.0), st.floats(0.05, 1.0))
def test_a_move_covers_its_distance_and_keeps_to_its_speed(distance: float, speed: float, ramp: float) -> None:
    profile = move_profile(distance, speed, ramp)
    time = np.linspace(0.0, profile.duration, 4001)
    velocity = np.array([profile.velocity_at(t) for t in time])
    assert np.trapezoid(velocity, time) == pytest.approx(distance, abs=2e-3 * abs(distance) + 1e-9)
    assert np.max(np.abs(velocity)) <= speed * (1.0 + 1e-12)
    assert velocity[0] == pytest.approx(0.0)


@given(st.integers(4, 20), st.integers(1, 3), st.integers(1, 5), st.integers(0, 5))
def test_every_plateau_stays_inside_the_travel(count: int, repeats: int, positions: int, seed: int) -> None:
    settings = SweepSettings(speed_count=count, repeats=repeats, positions=positions, seed=seed)
    plan = plan_plateaus(default_speeds(TRAVEL, settings), TRAVEL, settings)
    low, high = plan.reach
    assert low >= TRAVEL.low - 1e-9
    assert high <= TRAVEL.high + 1e-9


def test_both_directions_are_visited_equally_often() -> None:
    settings = SweepSettings(repeats=2)
    velocity = [p.velocity for p in plan_plateaus([0.1, 0.2, 0.4, 0.8], TRAVEL, settings).plateaus]
    assert sorted(velocity) == sorted(-v for v in velocity)
    assert len(velocity) == 16


def test_the_order_is_shuffled_by_the_seed_alone() -> None:
    speeds = np.geomspace(0.01, 1.0, 12)
    plans = [plan_plateaus(speeds, TRAVEL, SweepSettings(seed=seed)) for seed in (0, 0, 1)]
    orders = [[p.velocity for p in plan.plateaus] for plan in plans]
    assert orders[0] == orders[1]
    assert orders[0] != orders[2]
    assert [abs(v) for v in orders[0]] != sorted(abs(v) for v in orders[0])


def test_out_and_back_run_over_the_same_window() -> None:
    plan = plan_plateaus([0.1, 0.4], TRAVEL, SweepSettings())
    for out, back in zip(plan.plateaus[::2], plan.plateaus[1::2], strict=True):
        assert (out.start, out.stop) == pytest.approx((back.stop, back.start))


def test_a_slow_plateau_lasts_until_the_encoder_has_counted_enough() -> None:
    coarse = Travel(-2.0, 2.0, 8.0, quantum=2.0 * np.pi / 4096)
    plan = plan_plateaus([0.05, 1.0], coarse, SweepSettings(dwell=1.0, repeats=1))
    slow = next(p for p in plan.plateaus if abs(p.velocity) == 0.05)
    assert slow.dwell * 0.05 / coarse.quantum >= 100.0 - 1e-9


def test_a_speed_too_high_for_the_travel_is_refused_with_the_highest() -> None:
    top = top_speed(TRAVEL, SweepSettings())
    with pytest.raises(ParameterError, match=f"highest speed is {top:.3g}"):
        plan_plateaus([2.0 * top], TRAVEL, SweepSettings())


def test_the_first_speed_comes_again_under_new_numbers() -> None:
    plan = plan_plateaus([0.1, 0.4], TRAVEL, SweepSettings())
    again = first_again(plan, 40).plateaus
    assert [p.velocity for p in again] == [p.velocity for p in plan.plateaus[:2]]
    assert [p.number for p in again] == [40, 41]
    assert all(p.is_first_again for p in again)


def test_signed_velocities_alternate_in_direction() -> None:
    plan = plan_velocities([0.1, 0.2, -0.3, -0.4, 0.5], TRAVEL, SweepSettings(), first=7)
    signs = [np.sign(p.velocity) for p in plan.plateaus]
    assert signs == [1, -1, 1, -1, 1]
    assert plan.plateaus[0].number == 7


def test_a_joint_that_turns_freely_gets_one_turn_about_where_it_is() -> None:
    travel = travel_of(JointCapabilities("wheel", velocity_limit=5.0), None, 10.0, at=3.0)
    assert travel.middle == pytest.approx(3.0)
    assert travel.length < 2.0 * np.pi
    assert travel.speed_limit == pytest.approx(4.0)


def test_settings_refuse_values_outside_their_range() -> None:
    ranges = ({"dwell": 0.0}, {"repeats": 0}, {"check_torque": 2.0}, {"loop": "mine"}, {"speeds": "x"}, {"seed": -1})
    endless = ({"warm_up": float("inf")}, {"bandwidth": float("nan")})
    for wrong in (*ranges, *endless):
        with pytest.raises(ParameterError):
            SweepSettings(**wrong)


def test_speeds_lie_on_the_grid_of_a_drive_that_takes_velocities_in_steps() -> None:
    step = 0.024
    travel, settings = Travel(-2.5, 2.5, 4.0, 1.5e-3, step), SweepSettings()
    plan = plan_plateaus(default_speeds(travel, settings), travel, settings)
    counts = plan.speeds / step
    assert np.allclose(counts, np.round(counts))
    assert counts[0] == pytest.approx(1.0)
    assert len(plan.plateaus) == 2 * settings.repeats * len(plan.speeds)
