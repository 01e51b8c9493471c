"""A vibration is a line in the spectrum of the residual, and noise has none that stands out."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.evidence.gates import find_vibration
from fricomp.diagnosis.record.result import DIAGNOSIS_SCHEMA, DiagnosisRecord
from fricomp.diagnosis.record.sentence import write_sentences
from fricomp.diagnosis.search.preparation import Baseline
from fricomp.diagnosis.search.tone import find_tone

_STEP = 0.02  # [s] between rows


def _prepared(residual: np.ndarray, parts: int = 1) -> Baseline:
    """Two recordings of equal length where `parts` is 2, rows every 20 ms, to and fro at 0.2 Hz, and twenty nulls."""
    rng = np.random.default_rng(0)
    grid = SimpleNamespace(centres=np.arange(residual.size // parts) * 20)
    velocity = np.cos(2.0 * np.pi * 0.2 * np.arange(residual.size // parts * 20) * 1e-3)
    problem = SimpleNamespace(grids=[grid] * parts, tracks=[SimpleNamespace(dt=1e-3, velocity=velocity)] * parts)
    nulls = [rng.standard_normal(residual.size) for _ in range(20)]
    fit = SimpleNamespace(residual=residual)
    return cast(Baseline, SimpleNamespace(problem=problem, fit=fit, null_residuals=nulls))


@pytest.mark.parametrize("parts", [1, 2])
def test_a_vibration_is_found_at_its_frequency(parts: int) -> None:
    time = np.arange(3000) * _STEP
    noise = np.random.default_rng(1).standard_normal(time.size)
    tone = find_tone(_prepared(noise + 0.5 * np.sin(2.0 * np.pi * 7.3 * time), parts))
    assert tone.frequency == pytest.approx(7.3, abs=tone.width)
    assert tone.width == pytest.approx(parts / 60.0)
    assert tone.energy > 2.5 * tone.energy_null
    assert tone.share > 0.5


def test_what_follows_a_periodic_motion_is_novibration() -> None:
    """A ripple over position on a motion of 0.2 Hz: lines at all of its multiples, none of which holds most."""
    time = np.arange(3000) * _STEP
    noise = np.random.default_rng(3).standard_normal(time.size)
    ripple = np.sin(20.0 * np.sin(2.0 * np.pi * 0.2 * time) + 0.7)
    assert find_vibration(_prepared(noise + ripple)) is None
    assert find_vibration(_prepared(noise + 2.0 * np.cos(2.0 * np.pi * 0.2 * time))) is None
    assert find_vibration(_prepared(noise + 0.5 * np.sin(2.0 * np.pi * 7.3 * time))) is not None


def test_noise_and_one_bad_moment_are_novibration() -> None:
    noise = np.random.default_rng(2).standard_normal(3000)
    noise[1500] += 300.0
    tone = find_tone(_prepared(noise))
    assert tone.energy < 2.0 * tone.energy_null


def test_a_vibration_is_said_with_its_frequency() -> None:
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="unknown_physics",
        sentences=(),
        location={"frequency": [(7.2, 7.4)], "velocity": [(0.1, 0.2)]},
    )
    assert "Something vibrates at 7.3 Hz, whatever the joint does." in write_sentences(record)
    assert not any("sits at" in line for line in write_sentences(record))
