"""The blind side of a proof reads the files beside it, writes its answer there, and says why where it has none."""

import json
from pathlib import Path

import numpy as np
import pytest

from fricomp.recording import Recording, write_recording
from fricomp.sim_bench.studies.kit.blind_diagnosis import main


def test_an_answer_is_written_beside_the_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.linspace(0.0, 3.0, 3001)
    write_recording(Recording(time, np.zeros_like(time), np.sin(time)), tmp_path / "recording.parquet")
    monkeypatch.chdir(tmp_path)
    assert main() == 0
    assert json.loads((tmp_path / "diagnosis.json").read_text())["verdict"] == "bad_data"
    assert not (tmp_path / "motion.csv").exists()


def test_a_folder_without_a_recording_is_refused_with_a_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main() == 2
    assert "no recording was given" in capsys.readouterr().err
    assert not (tmp_path / "diagnosis.json").exists()
