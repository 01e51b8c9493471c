"""Friction laws in other forms than the catalogue of the diagnosis has them."""

from collections.abc import Callable
from math import log

import pytest

from fricomp.sim_bench.studies.second_generator import other_law
from fricomp.sim_bench.studies.second_generator.law import Acting, Law, State, dry_level

_STEP = 1e-3


def _hold(law: Law, velocity: float, seconds: float, load: float = 0.0, command: float = 0.0) -> Acting:
    """What acts after this time at one velocity."""
    acting = Acting(0.0)
    for _ in range(round(seconds / _STEP)):
        acting = law(State(0.0, _STEP, 0.0, velocity, load, command, 0.0))
    return acting


@pytest.mark.parametrize(
    ("law", "rise"),
    [
        (other_law.LogarithmicDwell(0.25, 0.05, 5e-3), lambda t: 0.25 * log(1.0 + t / 0.05)),
        (other_law.PowerDwell(0.8, 0.4, 0.1), lambda t: 0.8 * t**0.4),
    ],
)
def test_friction_grows_at_rest_by_its_law_and_is_lost_in_sliding(law: Law, rise: Callable[[float], float]) -> None:
    assert _hold(law, 0.0, 0.5).level == pytest.approx(dry_level(0.0) + rise(0.5), rel=0.01)
    assert _hold(law, 0.0, 1.5).level == pytest.approx(dry_level(0.0) + rise(2.0), rel=0.01)
    assert _hold(law, 0.3, 2.0).level == pytest.approx(dry_level(0.3), rel=1e-6)


def test_friction_is_that_of_the_velocity_some_time_ago() -> None:
    delayed, twice = other_law.DelayedFriction(10), other_law.TwiceLateFriction(5e-3)
    assert _hold(delayed, 0.5, 10 * _STEP).level == pytest.approx(dry_level(0.0))
    assert _hold(delayed, 0.5, _STEP).level == pytest.approx(dry_level(0.5))
    assert _hold(twice, 0.05, _STEP).level > 0.99 * dry_level(0.0)  # a second order begins flat
    assert _hold(twice, 0.05, 0.1).level == pytest.approx(dry_level(0.05), rel=1e-6)


def test_friction_grows_with_the_load_only_where_the_motor_lifts() -> None:
    law = other_law.driving_alone(0.12)
    assert _hold(law, 0.2, _STEP, load=5.0).level == pytest.approx(dry_level(0.2) + 0.6)
    assert _hold(law, -0.2, _STEP, load=5.0).level == pytest.approx(dry_level(0.2))


def test_a_drive_gives_less_than_it_is_asked_for() -> None:
    band = other_law.dead_band(0.4)
    assert [_hold(band, 0.0, _STEP, command=c).torque for c in (0.3, 2.0, -2.0)] == [-0.3, -0.4, 0.4]
    assert _hold(other_law.LimitedRate(60.0), 0.0, 0.02, command=3.0).torque == pytest.approx(1.2 - 3.0)


def test_a_motor_heats_in_two_parts() -> None:
    heated = other_law.TwiceHeatedMotor((2e-3, 3e-3), (0.1, 1e6))
    assert _hold(heated, 0.0, 2.0, command=5.0).gain == pytest.approx(1.0 - 2e-3 * 25.0, rel=1e-3)
