"""What swings is told from noise of any colour, and does not count as noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.spectrum import estimate_floor, is_structured

_M = 4000
_RNG = np.random.default_rng(11)
_NULLS = [_RNG.normal(size=_M) for _ in range(16)]


def _coloured(pole: float) -> FloatArray:
    return np.asarray(lfilter([1.0], [1.0, -pole], np.random.default_rng(12).normal(size=_M)))


def _swinging(damping: float) -> FloatArray:
    """What a mass on a spring makes of noise, at a seventh of the rate of the rows."""
    radius, angle = np.exp(-damping), 2.0 * np.pi / 7.0
    shaken = np.random.default_rng(13).normal(size=_M)
    return np.asarray(lfilter([1.0], [1.0, -2.0 * radius * np.cos(angle), radius**2], shaken))


@pytest.mark.parametrize("pole", [-0.6, 0.0, 0.5, 0.9])
def test_a_colour_is_no_structure(pole: float) -> None:
    assert not is_structured(_coloured(pole), _NULLS)


def test_a_bad_moment_is_no_structure() -> None:
    hit = np.random.default_rng(14).normal(size=_M)
    hit[1700:1703] = 80.0
    assert not is_structured(hit, _NULLS)


@pytest.mark.parametrize("pole", [0.0, 0.9])
def test_a_line_is_structure(pole: float) -> None:
    noise = _coloured(pole)
    line = np.sin(2.0 * np.pi * 0.137 * np.arange(_M))
    assert is_structured(noise / np.std(noise) + 0.35 * line, _NULLS)


def test_a_broad_peak_is_structure() -> None:
    assert is_structured(_swinging(0.1), _NULLS)


def test_rows_too_few_for_bands_have_lines_only() -> None:
    nulls = [one[:100] for one in _NULLS]
    assert not is_structured(_swinging(0.5)[:100], nulls)
    assert is_structured(nulls[0] + 3.0 * np.sin(0.9 * np.arange(100)), nulls)


def test_lines_do_not_raise_the_floor() -> None:
    noise, time = 0.3 * _NULLS[3], np.arange(_M)
    lines = sum(np.sin(2.0 * np.pi * frequency * time) for frequency in (0.05, 0.137, 0.31))
    assert np.std(noise + lines) > 1.0
    assert estimate_floor(noise + lines) == pytest.approx(0.3, rel=0.1)
    assert estimate_floor(noise) == pytest.approx(0.3, rel=0.05)
