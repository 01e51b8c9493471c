"""Concealed effects that once were missed: each case says what hid it."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.diagnosis import diagnose
from fricomp.recording import read_recording
from fricomp.sim_bench.cases import CaseSpec, generate, write_case


@pytest.mark.slow
def test_a_bristle_little_softer_than_the_base_allows(tmp_path: Path) -> None:
    """The base has bent to its softest one, and its Jacobian leads nowhere there."""
    spec = CaseSpec(
        986000, ("presliding_hysteresis",), "0.1", "fourier", 30.0, "jittered", "lugre", "quasi_direct", "dahl"
    )
    folder = write_case(generate(spec), tmp_path)
    found = diagnose(read_recording(folder / "recording.parquet"), folder / "joint.xml")
    assert [effect.name for effect in found.effects] == ["presliding_hysteresis"]


@pytest.mark.slow
def test_a_gap_beside_a_stop(tmp_path: Path) -> None:
    """What narrows down the hypotheses of a gap must not be the stop, which leaves a hundred times as much."""
    spec = CaseSpec(7, ("backlash", "end_stop"), "clear", "rich", 30.0, "quantised", "set_valued", "harmonic")
    folder = write_case(generate(spec), tmp_path)
    found = diagnose(read_recording(folder / "recording.parquet"), folder / "joint.xml")
    assert {effect.name for effect in found.effects} == {"backlash", "end_stop"}
