"""A concealed soft bristle is named where the base has bent to its softest one: its Jacobian there leads nowhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.recording import read_recording
from fricomp.sim_bench.concealed import CaseSpec, generate, write_case
from fricomp.sim_bench.diagnosis import diagnose


@pytest.mark.slow
def test_a_bristle_little_softer_than_the_base_allows(tmp_path: Path) -> None:
    spec = CaseSpec(
        986000, ("presliding_hysteresis",), "0.1", "fourier", 30.0, "jittered", "lugre", "quasi_direct", "dahl"
    )
    folder = write_case(generate(spec), tmp_path)
    found = diagnose(read_recording(folder / "recording.parquet"), folder / "joint.xml")
    assert [effect.name for effect in found.effects] == ["presliding_hysteresis"]
