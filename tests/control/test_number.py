"""A value of the wrong type, or an absurd one, is refused by an error of the library's own where it moves a joint."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

from fricomp.adapters import Transmission
from fricomp.adapters.trial import TrialSettings
from fricomp.control import JointLimits, SafetyGate
from fricomp.control.loop.real_time import RealTimeOptions
from fricomp.control.number import is_number
from fricomp.control.settings import CompensationSettings, DriveLimits, LoopDynamics
from fricomp.errors import FricompError
from fricomp.sim_bench.stand_in.backend import SimulatedJointAdapter

WRONG: tuple[Any, ...] = (True, "x", b"x", float("nan"), 1e300, -1e300, 1j, [1.0], ...)
LIMITS: dict[str, Any] = {"torque": 5.0, "torque_rate": 100.0, "velocity": 10.0}
LOOP = {"inertia": 0.1, "stiffness": 1.0, "damping": 1.0}
SETTINGS = {
    "source": "reference",
    "measured_share": 0.0,
    "smoothing": 0.01,
    "gain": 0.9,
    "authority": 1.0,
    "velocity_range": (-1.0, 1.0),
    "fade_width": 0.1,
}


def configured(**options: Any) -> None:
    adapter = SimulatedJointAdapter()
    period = options.pop("period", 1e-3)
    adapter.open()
    try:
        adapter.options = dataclasses.replace(adapter.options, **options)
        adapter.configure("torque", period)
    finally:
        adapter.close()


def keyed(make: Callable[..., Any], names: str, **given: Any) -> dict[str, Callable[[Any], Any]]:
    label = getattr(make, "__name__", "")
    return {f"{label}.{name}": partial(_make, make, given, name) for name in names.split()}


def _make(make: Callable[..., Any], given: dict[str, Any], name: str, value: Any) -> Any:
    return make(**{**given, name: value})


CASES: dict[str, Callable[[Any], Any]] = {
    **keyed(JointLimits, "torque torque_rate velocity position temperature breakaway", **LIMITS),
    **keyed(SafetyGate, "limits period ramp_time stale_after", limits=[JointLimits(**LIMITS)], period=1e-3),
    **keyed(configured, "limits ramp_time stale_after period"),
    **keyed(TrialSettings, "period share ramp_time largest_motion listen_time"),
    **keyed(LoopDynamics, "inertia stiffness damping delay velocity_filter", **LOOP),
    **keyed(Transmission, "gear_ratio sign zero motion"),
    **keyed(RealTimeOptions, "priority core"),
    **keyed(CompensationSettings, "source measured_share smoothing gain authority velocity_range", **SETTINGS),
    **keyed(CompensationSettings, "dead_band rest_velocity error_rate error_band", **SETTINGS),
}


@pytest.mark.parametrize("value", WRONG, ids=repr)
@pytest.mark.parametrize("case", CASES)
def test_a_value_that_is_no_sane_number_is_refused_in_our_own_words(case: str, value: Any) -> None:
    with pytest.raises(FricompError):
        CASES[case](value)


@pytest.mark.parametrize("value", [True, "x", b"x", float("nan"), 1j, [1.0], ...], ids=repr)
@pytest.mark.parametrize("name", ["torque", "torque_rate"])
def test_a_drive_without_limits_is_said_by_infinity_alone(name: str, value: Any) -> None:
    assert DriveLimits(**{name: float("inf")}) == DriveLimits()
    with pytest.raises(FricompError):
        DriveLimits(**{name: value})


@pytest.mark.parametrize("value", [1, "yes", None])
def test_doing_without_a_watchdog_is_said_by_true_alone(value: Any) -> None:
    with pytest.raises(FricompError, match="allow_no_watchdog"):
        configured(allow_no_watchdog=value)


@pytest.mark.parametrize("value", [1, 1.0, np.float32(1.0), np.float64(1.0), np.int64(1)])
def test_numbers_of_numpy_are_numbers(value: Any) -> None:
    assert is_number(value)
    assert JointLimits(torque=value, torque_rate=value, velocity=value).torque == 1.0
