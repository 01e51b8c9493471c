"""`fricomp bench mismatch` and `fricomp cases` as a user meets them."""

import json
import subprocess
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.bench import mismatch, mismatch_speed_up
from fricomp.cli.cases import app as cases_app
from fricomp.errors import DiagnosisError
from fricomp.sim_bench.studies import proof
from fricomp.sim_bench.studies.proof import settings
from tests.sim_bench.studies.proof.answering import always_consistent


@pytest.fixture
def quick_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(proof, "run_proof", partial(proof.run_proof, diagnose=always_consistent))
    monkeypatch.setattr(proof, "plan_run", lambda settings: _short(settings.cases))


def _short(count: int) -> list[proof.PlannedCase]:
    from fricomp.sim_bench.cases import CaseSpec

    return [proof.PlannedCase("null", CaseSpec(seed, duration=6.0)) for seed in range(count)]


@pytest.mark.usefixtures("quick_answers")
def test_a_run_writes_scores_failures_and_page_and_can_be_resumed(tmp_path: Path) -> None:
    out, page = tmp_path / "run", tmp_path / "docs" / "proof.md"
    page.parent.mkdir()
    options = ["--quick", "--cases", "2", "--executor", "serial", "--out", str(out), "--page", str(page)]
    first = CliRunner().invoke(mismatch.app, options, catch_exceptions=False)
    assert first.exit_code == 0
    assert "where nothing is missing" in first.stdout
    assert (out / "failures.md").read_text().startswith("# 0 wrong answers of 2")
    assert (page.parent / "proof" / "scores.parquet").exists()
    assert len((page.parent / "proof" / "seals.jsonl").read_text().splitlines()) == 2
    with pytest.raises(DiagnosisError, match="give --resume"):
        CliRunner().invoke(mismatch.app, options, catch_exceptions=False)
    longer = [*options[:2], "3", *options[3:], "--resume"]
    assert CliRunner().invoke(mismatch.app, longer, catch_exceptions=False).exit_code == 0
    assert len(proof.read_scores(out)) == 3


@pytest.mark.usefixtures("quick_answers")
def test_the_speed_up_is_printed_with_the_load_and_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = proof.SpeedUp(
        workers=2,
        one=(112.0, 51.0, 45.0),
        one_core=(120.0, 60.0, 50.0),
        several=(64.0, 30.0, 50.0),
        loops=(1.9, 1.95, 2.0),
        load=0.3,
        cores=2,
    )
    monkeypatch.setattr(proof, "measure_speed_up", lambda planned, progress: found)
    options = ["--cases", "4", "--out", str(tmp_path / "speed")]
    done = CliRunner().invoke(mismatch_speed_up.app, options, catch_exceptions=False)
    assert "2 workers are 1.88 times as fast as one that has one core" in done.stdout
    assert "1.70 times as fast as one that may use all 2" in done.stdout
    assert "load average of 0.30 before" in done.stdout
    assert "plain loops that share nothing are 1.95 times as fast" in done.stdout
    assert json.loads((tmp_path / "speed" / "speed_up.json").read_text())["ratio"] == pytest.approx(1.875)


def test_a_scored_run_outside_the_repository_is_refused_before_anything_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DiagnosisError, match="git repository"):
        CliRunner().invoke(mismatch.app, ["--scored", "--out", str(tmp_path / "run")], catch_exceptions=False)
    assert not (tmp_path / "run").exists()
    assert not (tmp_path / "docs").exists()


@pytest.mark.parametrize("kind", ["--nulls", "--clear", "--quick", "--injected"])
def test_some_kinds_of_cases_alone_are_no_scored_run(tmp_path: Path, kind: str) -> None:
    options = [kind, "--scored", "--out", str(tmp_path / "run")]
    with pytest.raises(DiagnosisError, match=f"leave out {kind}"):
        CliRunner().invoke(mismatch.app, options, catch_exceptions=False)
    assert not (tmp_path / "run").exists()


@pytest.mark.usefixtures("quick_answers")
def test_nulls_alone_are_made_and_scored(tmp_path: Path) -> None:
    page = tmp_path / "false_alarms.md"
    options = ["--nulls", "--quick", "--cases", "3", "--executor", "serial", "--out", str(tmp_path / "run")]
    options += ["--page", str(page)]
    told = CliRunner().invoke(mismatch.app, options, catch_exceptions=False).stdout
    assert "where nothing is missing" in told
    assert "of 3" in told
    assert "fricomp bench mismatch --quick --nulls --cases 3 --first-seed 0" in page.read_text()


@pytest.mark.usefixtures("quick_answers")
def test_a_scored_run_goes_in_pieces_and_its_log_tells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = tmp_path / "sim_bench" / "diagnosis" / "search.py"
    source.parent.mkdir(parents=True)
    source.write_text("threshold = 1\n")
    for name in ("concealed", "proof"):
        (source.parents[1] / name).mkdir()
        (source.parents[1] / name / "code.py").write_text(f"{name} = 1\n")
    identity = ("-c", "user.name=test", "-c", "user.email=test@example.org")
    for call in (("init", "-q"), ("add", "."), ("commit", "-q", "-m", "diagnosis")):
        subprocess.run(["git", "-C", str(tmp_path), *identity, *call], check=True, capture_output=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(settings, "imported_diagnosis", source.parent.resolve)
    (tmp_path / "docs").mkdir()
    options = ["--scored", "--cases", "3", "--executor", "serial", "--resume", "--out", "run"]
    options += ["--page", "docs/proof.md"]
    monkeypatch.setattr(proof, "watch", lambda *_: iter([True, True, False]).__next__)
    first = CliRunner().invoke(mismatch.app, [*options, "--minutes", "1"], catch_exceptions=False)
    assert "1 of 3 cases are left: --resume goes on" in first.stdout
    assert "2 of 3 cases, in the order of the plan" in (tmp_path / "docs" / "proof.md").read_text()
    monkeypatch.setattr(proof, "watch", lambda *_: lambda: True)
    CliRunner().invoke(mismatch.app, options, catch_exceptions=False)
    log = proof.read_entries(tmp_path / "docs" / "proof" / "runs.jsonl")
    assert [(entry["event"], entry["cases"]) for entry in log] == [("started", 3), ("paused", 2), ("finished", 3)]
    assert "Scored run 1" in (tmp_path / "docs" / "proof.md").read_text()


def test_cases_can_be_made_and_listed(tmp_path: Path) -> None:
    made = CliRunner().invoke(
        cases_app, ["make", "--effect", "end_stop", "--duration", "8", "--out", str(tmp_path / "cases")]
    )
    assert made.exit_code == 0
    assert "fricomp diagnose" in made.stdout
    answer = next((tmp_path / "cases.answers").glob("*.json"))
    assert json.loads(answer.read_text())["effects"][0]["name"] == "end_stop"
    listed = CliRunner().invoke(cases_app, ["list"])
    assert "cable_memory" in listed.stdout
    assert "set_valued" in listed.stdout
