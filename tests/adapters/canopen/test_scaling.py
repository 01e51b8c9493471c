"""What a count of a CiA 402 drive is in SI, from objects whose meaning is known [cia402]."""

from math import inf, tau
from typing import Any

import pytest

from fricomp.adapters.canopen import objects
from fricomp.adapters.canopen.objects import CanOpenObject
from fricomp.adapters.canopen.scaling import DriveScaling, read_scaling
from fricomp.adapters.canopen.state_machine import ENABLE_STEPS, ENERGISED, DriveState, decode_state
from fricomp.errors import AdapterConfigurationError

ENCODER = {objects.ENCODER_INCREMENTS: 8192, objects.ENCODER_REVOLUTIONS: 2}
FEED = {objects.FEED: 360_000, objects.FEED_SHAFT_REVOLUTIONS: 1}
GEAR = {objects.GEAR_MOTOR_REVOLUTIONS: 100, objects.GEAR_SHAFT_REVOLUTIONS: 3}


class Drive:
    """The objects that a drive has; one that it lacks is absent."""

    def __init__(self, *parts: dict[CanOpenObject, int], rated: int = 2000) -> None:
        self._values = {objects.RATED_TORQUE: rated} | {entry: value for part in parts for entry, value in part.items()}

    def read(self, entry: CanOpenObject) -> int:
        return self._values[entry]

    def read_if_present(self, entry: CanOpenObject) -> int | None:
        return self._values.get(entry)


def scaling_of(*parts: dict[CanOpenObject, int], rated: int = 2000, **given: Any) -> DriveScaling:
    service: Any = Drive(*parts, rated=rated)
    return read_scaling(service, given.get("counts_per_revolution"), given.get("velocity_count"))


def test_torque_counts_thousandths_of_the_rated_torque_in_millinewton_metres() -> None:
    scaling = scaling_of(ENCODER, {objects.MAX_TORQUE: 3000})
    assert scaling.torque == pytest.approx(2e-3)
    assert scaling.highest_torque == pytest.approx(6.0)
    assert scaling.highest_torque_count == 3000


@pytest.mark.parametrize("told", [{}, {objects.MAX_TORQUE: 0}, {objects.MAX_TORQUE: 0xFFFF}])
def test_torque_is_never_more_than_16_bits_hold(told: dict[CanOpenObject, int]) -> None:
    assert scaling_of(ENCODER, told).highest_torque_count == 32767


def test_a_torque_is_rounded_toward_zero_and_whole_counts_are_kept() -> None:
    scaling = DriveScaling(1.0, 1.0, 1e-3, 1.0, 1.0)
    assert [scaling.count_within(torque) for torque in (0.0019, 0.003, 0.7)] == [1, 3, 700]
    assert scaling.count_within(0.29) == 290, "0.29 / 0.001 falls below 290 by rounding"


def test_position_counts_come_from_the_encoder_or_before_it_from_feed_and_gear() -> None:
    assert scaling_of(ENCODER).position == pytest.approx(tau / 4096)
    assert scaling_of(ENCODER, FEED).position == pytest.approx(tau / 360_000)
    assert scaling_of(ENCODER, FEED, GEAR).position == pytest.approx(tau / 10_800)
    assert scaling_of(ENCODER, FEED, counts_per_revolution=1000.0).position == pytest.approx(tau / 1000)


@pytest.mark.parametrize("part", [{}, {objects.ENCODER_INCREMENTS: 4096}, ENCODER | {objects.ENCODER_INCREMENTS: 0}])
def test_a_drive_that_does_not_tell_its_counts_is_refused(part: dict[CanOpenObject, int]) -> None:
    with pytest.raises(AdapterConfigurationError, match="counts_per_revolution"):
        scaling_of(part)


def test_a_rated_torque_of_zero_is_refused() -> None:
    with pytest.raises(AdapterConfigurationError, match="6076"):
        scaling_of(ENCODER, rated=0)
    assert scaling_of(ENCODER, rated=1).torque == pytest.approx(1e-6)


@pytest.mark.parametrize(
    ("unit", "count"),
    [
        (0x00B44700, tau / 60.0),
        (0xFEB44700, tau / 6000.0),
        (0x01B44700, tau / 6.0),
        (0x80B44700, tau / 60.0 * 1e-128),
        (0x00410300, tau / 4096),  # revolutions a second are not told in this way
        (0, tau / 4096),
    ],
)
def test_velocity_counts_revolutions_a_minute_or_position_counts_a_second(unit: int, count: float) -> None:
    assert scaling_of(ENCODER, {objects.VELOCITY_UNIT: unit}).velocity == pytest.approx(count, rel=1e-12, abs=0.0)
    assert scaling_of(ENCODER, {objects.VELOCITY_UNIT: unit}, velocity_count=0.5).velocity == 0.5


def test_the_highest_speed_is_told_in_revolutions_a_minute_or_is_unknown() -> None:
    assert scaling_of(ENCODER, {objects.MAX_MOTOR_SPEED: 3000}).highest_velocity == pytest.approx(50.0 * tau)
    assert scaling_of(ENCODER).highest_velocity == inf
    assert scaling_of(ENCODER).velocity == pytest.approx(tau / 4096)


@pytest.mark.parametrize(
    ("statusword", "state", "step"),
    [
        (0x0000, DriveState.NOT_READY, 0x00),
        (0x0250, DriveState.SWITCH_ON_DISABLED, 0x06),
        (0x0231, DriveState.READY_TO_SWITCH_ON, 0x07),
        (0x0233, DriveState.SWITCHED_ON, 0x0F),
        (0x1637, DriveState.OPERATION_ENABLED, 0x0F),
        (0x0617, DriveState.QUICK_STOP_ACTIVE, 0x00),
        (0x021F, DriveState.FAULT_REACTION_ACTIVE, None),
        (0x0218, DriveState.FAULT, None),
        (0x0238, DriveState.FAULT, None),  # bit 5 says nothing in a fault
        (0x0270, DriveState.SWITCH_ON_DISABLED, 0x06),
    ],
)
def test_a_statusword_tells_the_state_and_the_next_step_out_of_it(
    statusword: int, state: DriveState, step: int | None
) -> None:
    assert decode_state(statusword) is state
    assert ENABLE_STEPS.get(state) == step


def test_a_motor_carries_current_while_it_is_enabled_or_brakes() -> None:
    assert {state.name for state in ENERGISED} == {"OPERATION_ENABLED", "QUICK_STOP_ACTIVE", "FAULT_REACTION_ACTIVE"}
