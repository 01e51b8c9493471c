"""The first look: loud or not, by how much, and where."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.problem import Problem
from fricomp.diagnosis.joint.solver import Fit
from fricomp.diagnosis.search.first_look import describe_first_look

_ROWS = 2000


class _Track:
    rotary = True

    def __init__(self) -> None:
        time = np.linspace(0.0, 40.0, _ROWS)
        self.position, self.velocity = np.sin(1.3 * time), 1.3 * np.cos(1.3 * time)


class _Grid:
    centres = np.arange(_ROWS)


class _Observer:
    rest_speed = 0.02


class _Rows:
    """What the first look reads of a problem."""

    tracks, grids, observer = (_Track(),), (_Grid(),), _Observer()


def _look(residual: FloatArray) -> str:
    fit = Fit(np.zeros(1), residual, np.zeros((residual.size, 1)), float(residual @ residual))
    return describe_first_look(cast(Problem, cast(Any, _Rows())), fit)


@pytest.fixture
def noise() -> FloatArray:
    return np.random.default_rng(0).standard_normal(_ROWS)


def test_noise_alone_is_told_as_noise(noise: FloatArray) -> None:
    assert "about as much as noise" in _look(noise)


def test_a_mismatch_in_a_part_of_the_range_is_told_with_its_place(noise: FloatArray) -> None:
    said = _look(noise + 20.0 * (np.abs(_Rows.tracks[0].position - 0.5) < 0.1))
    assert "something is missing" in said
    low, high = (float(word) for word in said.split("at positions from ")[1].removesuffix(" rad").split(" to "))
    assert low < 0.45 < 0.55 < high


def test_a_mismatch_about_rest_is_told_as_such(noise: FloatArray) -> None:
    assert "about rests and reversals" in _look(noise + 30.0 * (np.abs(_Rows.tracks[0].velocity) < 0.03))


def test_a_mismatch_everywhere_has_no_place(noise: FloatArray) -> None:
    said = _look(3.0 * noise)
    assert said.startswith("first look: something is missing, 3")
    assert " of it " not in said
