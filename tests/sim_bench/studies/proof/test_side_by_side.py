"""Two runs of the same cases side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from fricomp.cli.bench.mismatch.compare import app
from fricomp.errors import DiagnosisError
from fricomp.sim_bench.studies.proof.side_by_side import compare_runs


def _write(folder: Path, case: str, verdict: str, *effects: tuple[str, float]) -> None:
    named: list[dict[str, Any]] = [
        {"name": name, "parameters": {"size": {"value": value, "unit": "1", "ci95": [value - 1.96, value + 1.96]}}}
        for name, value in effects
    ]
    place = folder / "diagnoses"
    place.mkdir(parents=True, exist_ok=True)
    record = {"schema": "fricomp.diagnosis/1", "verdict": verdict, "effects": named}
    (place / f"{case}.json").write_text(json.dumps(record), encoding="utf-8")


@pytest.fixture
def runs(tmp_path: Path) -> tuple[Path, Path]:
    first, second = tmp_path / "first", tmp_path / "second"
    _write(first, "case-a", "missing_physics", ("cogging", 5.0), ("backlash", 1.0))
    _write(second, "case-a", "missing_physics", ("backlash", 1.0), ("cogging", 5.5))
    _write(first, "case-b", "consistent")
    _write(second, "case-b", "missing_physics", ("cogging", 2.0))
    _write(first, "case-c", "consistent")
    return first, second


def test_answers_differ_by_verdict_and_names_whatever_their_order(runs: tuple[Path, Path]) -> None:
    same, changed = compare_runs(*runs)
    assert not same.differs
    assert same.shift == pytest.approx(0.5)
    assert changed.differs
    assert changed.after == ("missing_physics", "cogging")


def test_runs_without_a_common_case_are_refused(runs: tuple[Path, Path], tmp_path: Path) -> None:
    with pytest.raises(DiagnosisError, match="no diagnosed case in common"):
        compare_runs(runs[0], tmp_path / "empty")


def test_the_command_says_what_changed_and_fails_where_asked(runs: tuple[Path, Path]) -> None:
    found = CliRunner().invoke(app, [str(one) for one in runs])
    assert found.exit_code == 0
    assert "2 cases, 1 with another verdict or name" in found.output
    assert CliRunner().invoke(app, [*(str(one) for one in runs), "--fail-if-changed"]).exit_code == 1
    assert CliRunner().invoke(app, [str(runs[0]), str(runs[0]), "--fail-if-changed"]).exit_code == 0
