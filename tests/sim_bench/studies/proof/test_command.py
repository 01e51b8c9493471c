"""`fricomp bench mismatch` and `fricomp cases` as a user meets them."""

import json
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fricomp.cli.bench import mismatch
from fricomp.cli.bench.mismatch import speed_up
from fricomp.cli.cases import app as cases_app
from fricomp.errors import DiagnosisError
from fricomp.sim_bench.studies import proof
from fricomp.sim_bench.studies.proof.speed_up import SpeedUp
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
    found = SpeedUp(
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
    done = CliRunner().invoke(speed_up.app, options, catch_exceptions=False)
    assert "2 workers are 1.88 times as fast as one that has one core" in done.stdout
    assert "1.70 times as fast as one that may use all 2" in done.stdout
    assert "load average of 0.30 before" in done.stdout
    assert "plain loops that share nothing are 1.95 times as fast" in done.stdout
    assert json.loads((tmp_path / "speed" / "speed_up.json").read_text())["ratio"] == pytest.approx(1.875)


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
    assert "fricomp bench mismatch run --quick --nulls --cases 3 --first-seed 0" in page.read_text()


@pytest.mark.usefixtures("quick_answers")
def test_a_scored_run_goes_in_pieces_and_is_replayed_from_beside_its_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, beside = tmp_path / "docs" / "proof.md", tmp_path / "docs" / "proof"
    options = ["run", "--scored", "--cases", "3", "--executor", "serial", "--resume", "--page", str(page)]
    monkeypatch.setattr(proof, "stop_after", lambda _: iter([True, True, False]).__next__)
    first = _call([*options, "--out", str(tmp_path / "run"), "--minutes", "1"])
    assert "1 of 3 cases are left: --resume goes on" in first
    assert "2 of 3 cases, in the order of the plan" in page.read_text()
    monkeypatch.setattr(proof, "stop_after", lambda _: lambda: True)
    _call([*options, "--out", str(tmp_path / "elsewhere")])
    text = page.read_text()
    assert "Scored run, measured at commit" in text
    _call(["page", "--out", str(tmp_path / "third"), "--page", str(page)])
    assert page.read_text() == text
    told = _call(["replay", str(beside), "--cases", "2", "--executor", "serial", "--out", str(tmp_path / "again")])
    assert f"2 cases in {tmp_path / 'again'}" in told
    with pytest.raises(DiagnosisError, match="of its own"):
        _call(["replay", str(beside), "--out", str(tmp_path / "again"), "--page", str(page)])


def _call(options: list[str]) -> str:
    done = CliRunner().invoke(mismatch.app, options, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout


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
