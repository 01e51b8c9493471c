"""Starts, time windows and orders found in the residual of a joint whose missing torque is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lsim, savgol_filter

from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.recording import Recording

from ..toy_joint import ToyJoint, record

pytestmark = pytest.mark.slow

JOINT = ToyJoint(gravity=0.0)


def baseline(columns: dict[str, NDArray[np.float64]], missing: NDArray[np.float64]) -> Baseline:
    """The base fitted to a joint that draws `missing` [N·m] more than its law; the motion is given, so it may."""
    recording = Recording(columns["time"], columns["position"], columns["torque"] + missing)
    return prepare(build_tracks([recording]), observer=Observer(), nulls=12, seed=0)


@pytest.fixture(scope="module")
def columns() -> dict[str, NDArray[np.float64]]:
    return record(JOINT, "rich", 20.0)


def hints(found: Baseline, name: str) -> tuple[float, ...]:
    return found.structure.contexts[0].hints.get(name, ())


def test_pushes_are_found_in_time(columns: dict[str, NDArray[np.float64]]) -> None:
    time = columns["time"]
    pushes = np.zeros_like(time)
    for start, end, size in ((4.0, 5.2, 1.0), (12.5, 13.5, -0.8)):
        inside = (time > start) & (time < end)
        pushes[inside] += size * np.sin(np.pi * (time[inside] - start) / (end - start))
    found = baseline(columns, pushes)
    assert hints(found, "window") == pytest.approx((0.0, 4.0, 5.2, 0.0, 12.5, 13.5), abs=0.15)


@pytest.mark.parametrize("stiffness", [10.0, 20.0, 40.0, 80.0])
def test_what_returns_with_the_state_is_no_push(columns: dict[str, NDArray[np.float64]], stiffness: float) -> None:
    """A stop in the last fifth of the range, met once or a few times."""
    position = columns["true_position"]
    found = baseline(columns, stiffness * np.maximum(position - 0.8 * position.max(), 0.0))
    assert hints(found, "window") == ()


def test_the_stiffness_of_a_spring_is_found(columns: dict[str, NDArray[np.float64]]) -> None:
    share, own, ratio = 0.6, 90.0, 0.05
    # Twist of the load against the motor, s'' = q'' - w² s - 2 ratio w s'.
    _, twist, _ = lsim(([1.0, 0.0, 0.0], [1.0, 2.0 * ratio * own, own**2]), columns["true_position"], columns["time"])
    missing = -share * JOINT.inertia * np.gradient(np.gradient(twist, 1e-3), 1e-3)
    missing[:50] = missing[-50:] = 0.0
    start = hints(baseline(columns, missing), "start:joint_elasticity")
    assert np.exp(start[0]) == pytest.approx(share * JOINT.inertia * own**2, rel=0.25)


def test_the_order_of_an_uneven_gear_is_found(columns: dict[str, NDArray[np.float64]]) -> None:
    q, v = columns["true_position"], columns["true_velocity"]
    n, size = 33.0, 2e-3
    error, slope = size * np.sin(n * q), size * n * np.cos(n * q)
    a = np.gradient(v, 1e-3)
    missing = 0.6 * JOINT.inertia * (2.0 * slope * a - n**2 * error * v**2)
    orders = hints(baseline(columns, missing), "dynamic_order")
    assert orders[0] == pytest.approx(n, rel=0.03)


def test_the_share_of_the_load_behind_a_small_gap_is_found() -> None:
    """Its share of the inertia tells when it changes sides; no refit finds its way there from impacts elsewhere."""
    joint, share, gap, own, substeps = ToyJoint(), 0.62, 1e-4, 600.0, 4
    columns = record(joint, "rich", 20.0)
    position, h = columns["true_position"], 1e-3 / substeps
    load, speed, twist = position[0], 0.0, np.zeros_like(position)
    for k in range(position.size - 1):
        twist[k], rate = position[k] - load, (position[k + 1] - position[k]) / 1e-3
        for i in range(substeps):
            away = position[k] + rate * h * i - load
            stretch = away - min(max(away, -0.5 * gap), 0.5 * gap)
            pushed = own**2 * stretch + own * (rate - speed) if stretch else 0.0
            speed += h * (pushed - joint.gravity * np.sin(position[k] + joint.phase) / (share * joint.inertia))
            load += h * speed
    missing = -share * joint.inertia * savgol_filter(twist, 15, 3, deriv=2, delta=1e-3)
    missing[:50] = missing[-50:] = 0.0
    start = hints(baseline(columns, missing), "start:backlash")
    # Beside a base that takes up a part of the impacts the best share is 0.59: a refit from here ends there.
    assert min(abs(one - share) for one in start[1::4]) < 0.035
