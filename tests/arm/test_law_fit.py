"""Friction that a law cannot have becomes the nearest that it can, and is left alone where it can."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from scipy.optimize import LinearConstraint, minimize

from fricomp.arm.friction import PLAIN
from fricomp.arm.friction_model import _build_core
from fricomp.arm.law_fit import _project
from fricomp.laws import BidirectionalStribeck


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_point_is_that_of_a_general_solver(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(5, 5)) + 2.0 * np.eye(5)
    H, A, start = root @ root.T, rng.normal(size=(3, 5)), rng.normal(size=5)
    b = A @ start + np.array([0.5, 0.3, -1.0])
    found = _project(start, H, A, b)

    def distance(f: np.ndarray) -> float:
        return float((f - start) @ H @ (f - start))

    best = minimize(distance, start, method="SLSQP", constraints=LinearConstraint(A, b, np.inf))
    assert np.all(A @ found >= b - 1e-9)
    assert distance(found) == pytest.approx(best.fun, rel=1e-3)


def test_a_slope_that_cannot_be_negative_gives_to_what_looks_like_it() -> None:
    """Two parameters that nearly do the same: one at its bound, the other takes over what it had to give up."""
    H = np.array([[1.0, 0.95], [0.95, 1.0]])
    found = _project(np.array([3.0, -1.0]), H, np.array([[0.0, 1.0]]), np.zeros(1))
    assert found == pytest.approx([3.0 - 0.95, 0.0], abs=1e-9)


@pytest.mark.parametrize("level", [-7e-11, 0.0, 1e-5])
def test_a_bristle_of_next_to_nothing_is_none(level: float) -> None:
    """Brought to the nearest that a law can have, one came out below zero by rounding, and no file was written."""
    values = dict.fromkeys(PLAIN, 0.1) | {"coulomb": 1.0, "presliding_hysteresis.level.3": level}
    (core,) = _build_core(cast(Any, None), 0, values, {"presliding_hysteresis": 3})
    assert isinstance(core, BidirectionalStribeck)
