"""A falling curve of another exponent than 2 is identified with its exponent, and one of 2 is left as it is."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.calibration.identification import identify
from fricomp.calibration.identification.exponent import asks_for_exponent, is_shown
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

SPEED = np.geomspace(0.01, 20.0, 50)


def _points(
    exponent: float, seed: int = 0, *, noise: float = 0.005, relative: bool = False, reverse: float | None = None
) -> tuple[FloatArray, FloatArray]:
    """A sweep of F_c 0.64, F_s 2.2 N·m, v_s 0.9 rad/s, viscous 0.05 N·m·s/rad."""
    velocity = np.concatenate([-SPEED[::-1], SPEED])
    size, shape = np.abs(velocity), np.where(velocity > 0.0, exponent, reverse or exponent)
    level = 0.64 + 1.56 * np.exp(-((size / 0.9) ** shape)) + 0.05 * size
    error = noise * np.random.default_rng([seed, 35]).normal(size=len(size))
    return velocity, np.sign(velocity) * (level * (1.0 + error) if relative else level + error)


@pytest.mark.parametrize(
    ("exponent", "relative", "seed"), [(0.67, True, 0), (1.0, False, 1), (1.4, True, 2), (3.0, False, 3)]
)
def test_another_exponent_comes_out_within_its_interval(exponent: float, relative: bool, seed: int) -> None:
    velocity, torque = _points(exponent, seed, relative=relative)
    found = fricomp.identify(velocity, torque, method="least_squares")
    result = found.result
    assert result.status == "converged"
    for side in ("forward", "reverse"):
        truth = {"stribeck_exponent": exponent, "static_torque": 2.2, "coulomb_torque": 0.64, "stribeck_velocity": 0.9}
        for name, value in truth.items():
            interval = result.interval(f"stribeck.{side}.{name}", 0.997)
            assert interval.holds(value), (side, name, interval)
        assert result.standard_deviations[f"stribeck.{side}.stribeck_exponent"] < 0.05 * exponent
    assert any("free_stribeck" in note for note in found.notes)
    assert result.model.law.parameters()["stribeck.forward.stribeck_exponent"] == pytest.approx(exponent, rel=0.1)


def test_each_direction_has_its_own_exponent() -> None:
    result = fricomp.identify(*_points(0.7, reverse=2.0), method="least_squares").result
    assert result.parameters["stribeck.forward.stribeck_exponent"] == pytest.approx(0.7, abs=0.05)
    assert result.parameters["stribeck.reverse.stribeck_exponent"] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("seed", range(8))
def test_a_curve_of_exponent_2_keeps_its_eight_parameters(seed: int) -> None:
    result = fricomp.identify(*_points(2.0, seed), method="least_squares").result
    assert len(result.parameter_names) == 8
    assert not asks_for_exponent(result)


def test_a_law_that_was_asked_for_is_kept() -> None:
    result = fricomp.identify(*_points(0.67), method="least_squares", law="stribeck").result
    assert len(result.parameter_names) == 8
    assert result.status == "lack_of_fit"


def test_a_hump_is_no_exponent() -> None:
    velocity, torque = _points(2.0)
    torque = torque + np.sign(velocity) * 0.3 * np.exp(-((np.log(np.abs(velocity) / 6.0) / 0.3) ** 2))
    fixed = identify(velocity, torque, method="least_squares")
    assert asks_for_exponent(fixed)
    assert not is_shown(fixed, identify(velocity, torque, method="least_squares", law="free_stribeck"))


def test_a_direction_with_four_points_has_no_exponent() -> None:
    velocity, torque = _points(0.67, noise=0.001)
    few = np.concatenate([np.flatnonzero(velocity < 0.0), 50 + np.array([5, 20, 30, 45])])
    with pytest.raises(IdentificationError, match="5 parameters in forward"):
        identify(velocity[few], torque[few], method="least_squares", law="free_stribeck")
    assert len(fricomp.identify(velocity[few], torque[few], method="least_squares").result.parameter_names) == 8
