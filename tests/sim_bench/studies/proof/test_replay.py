"""A scored run is made again from what is kept of it, held against its seals, and closed."""

import hashlib
import json
import shutil
import subprocess
from functools import partial
from pathlib import Path

import msgspec
import pytest
import typer
from pyarrow import Table, parquet
from typer.testing import CliRunner

from fricomp.cli.bench import mismatch, mismatch_close, mismatch_replay
from fricomp.errors import DiagnosisError
from fricomp.fleet import SerialExecutor
from fricomp.sim_bench.cases import CaseSpec
from fricomp.sim_bench.studies import proof
from fricomp.sim_bench.studies.proof import PlannedCase, RunSettings, read_entries, replay, settings
from tests.sim_bench.studies.proof.answering import always_consistent


def _git(folder: Path, *arguments: str) -> None:
    identity = ("-c", "user.name=test", "-c", "user.email=test@example.org")
    subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True, capture_output=True)


def _plan(wanted: RunSettings) -> list[PlannedCase]:
    seeds = proof.scored_seeds(wanted.tree, wanted.run)
    return [PlannedCase("null", CaseSpec(next(seeds), duration=5.0)) for _ in range(min(wanted.cases, 3))]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository in which a scored run of two cases was made and is kept."""
    folder = tmp_path_factory.mktemp("repository")
    for name in ("diagnosis", "concealed", "proof"):
        (folder / "sim_bench" / name).mkdir(parents=True)
        (folder / "sim_bench" / name / "code.py").write_text(f"{name} = 1\n")
    _git(folder, "init", "-q")
    _git(folder, "add", ".")
    _git(folder, "commit", "-q", "-m", "code")
    (folder / "docs").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        _enter(folder, patch)
        _call("--scored", "--cases", "2", "--out", "run", "--page", "docs/proof.md")
    return folder


@pytest.fixture
def checkout(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of that repository to work in."""
    folder = tmp_path / "repository"
    shutil.copytree(made, folder)
    _enter(folder, monkeypatch)
    return folder


def _enter(folder: Path, patch: pytest.MonkeyPatch) -> None:
    patch.chdir(folder)
    patch.setenv("COLUMNS", "200")
    patch.setattr(settings, "imported_diagnosis", (folder / "sim_bench" / "diagnosis").resolve)
    patch.setattr(proof, "run_proof", partial(proof.run_proof, diagnose=always_consistent))
    for module in (proof, replay):
        patch.setattr(module, "plan_run", _plan)


def _call(*options: str) -> str:
    return _invoke(mismatch.app, *options, "--executor", "serial")


def _replay(*options: str) -> str:
    return _invoke(mismatch_replay.app, *options, "--executor", "serial")


def _close(reason: str) -> str:
    return _invoke(mismatch_close.app, reason)


def _invoke(app: typer.Typer, *options: str) -> str:
    result = CliRunner().invoke(app, options, catch_exceptions=False)
    assert result.exit_code == 0
    return result.stdout


def _log(checkout: Path) -> list[str]:
    return [entry["event"] for entry in read_entries(checkout / "docs/proof/runs.jsonl")]


def test_a_scored_run_keeps_which_code_made_it(checkout: Path) -> None:
    kept = json.loads((checkout / "docs/proof/run.json").read_text())
    assert all(len(kept[name]) == 40 for name in ("tree", "generator", "scorer", "commit"))
    assert read_entries(checkout / "docs/proof/runs.jsonl")[0]["commit"] == kept["commit"]


def test_answers_made_again_have_the_hash_that_was_sealed(checkout: Path) -> None:
    assert "2 answers made again have the hash that was sealed" in _replay("1", "--verify")
    assert _log(checkout) == ["started", "finished"]


def test_an_answer_that_was_sealed_with_another_hash_is_told(checkout: Path) -> None:
    seals = checkout / "docs/proof/seals.jsonl"
    first, second = map(json.loads, seals.read_text().splitlines())
    seals.write_text("\n".join(map(json.dumps, (first | {"sha256": second["sha256"]}, second))) + "\n")
    with pytest.raises(DiagnosisError, match=f"1 tell something else than was sealed, {first['case']} first"):
        _replay("1", "--verify")


def _as_if_another_processor_had_made_it(proof_folder: Path, factor: float) -> None:
    """Change the gravity of the first opened answer, and its seal with it."""
    rows = parquet.read_table(proof_folder / "answers.parquet").to_pylist()
    answer = json.loads(rows[0]["answer"])
    answer["joint"]["gravity"] *= factor
    rows[0]["answer"] = json.dumps(answer).encode()
    parquet.write_table(Table.from_pylist(rows), proof_folder / "answers.parquet")
    seals = [json.loads(line) for line in (proof_folder / "seals.jsonl").read_text().splitlines()]
    for seal in seals:
        if seal["case"] == rows[0]["case"]:
            seal["sha256"] = hashlib.sha256(rows[0]["answer"]).hexdigest()
    (proof_folder / "seals.jsonl").write_text("\n".join(map(json.dumps, seals)) + "\n")


def test_an_answer_of_another_processor_tells_the_same_with_another_hash(checkout: Path) -> None:
    _as_if_another_processor_had_made_it(checkout / "docs/proof", factor=1.02)
    told = _replay("1", "--verify")
    assert "1 answers made again have the hash that was sealed, 1 another that tells the same" in told


def test_an_answer_of_another_joint_is_told_though_its_seal_fits(checkout: Path) -> None:
    _as_if_another_processor_had_made_it(checkout / "docs/proof", factor=1.1)
    with pytest.raises(DiagnosisError, match="1 tell something else than was sealed"):
        _replay("1", "--verify")


def test_a_seal_that_the_plan_does_not_lead_to_is_told(checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "plan_run", lambda wanted: _plan(wanted)[1:])
    found = replay.verify_seals(1, checkout / "docs/proof/runs.jsonl", (SerialExecutor(), 1), checkout)
    assert (found.agree, len(found.unplanned), found.holds) == (1, 1, False)


def test_another_generator_does_not_replay_a_run(checkout: Path) -> None:
    (checkout / "sim_bench/cases/code.py").write_text("concealed = 2\n")
    _git(checkout, "commit", "-q", "-a", "-m", "another generator")
    for options in (("--verify",), ("--out", "again")):
        with pytest.raises(DiagnosisError, match="check out commit"):
            _replay("1", *options)
    assert not (checkout / "again").exists()


def test_a_replay_has_the_cases_and_the_salt_of_its_run_and_no_entry_in_the_log(checkout: Path) -> None:
    _replay("1", "--out", "again")
    first, again = (set((checkout / run / "seals.jsonl").read_text().splitlines()) for run in ("run", "again"))
    assert first == again
    assert _log(checkout) == ["started", "finished"]
    assert json.loads((checkout / "again/run.json").read_text())["replayed"]
    with pytest.raises(DiagnosisError, match="of its own"):
        _replay("1", "--out", "again", "--page", "docs/proof.md")
    with pytest.raises(DiagnosisError, match="scored run 7 is kept"):
        _replay("7", "--out", "other")


def test_a_closed_run_has_its_reason_in_the_log_and_its_data_in_a_folder_of_its_own(checkout: Path) -> None:
    assert "scored run 1 is closed" in _close("one core only")
    folder = checkout / "docs/proof"
    assert read_entries(folder / "runs.jsonl")[-1] | {"tree": ""} == {
        "run": 1, "tree": "", "event": "closed", "reason": "one core only",
    }  # fmt: skip
    kept = {path.name for path in (folder / "run-1").iterdir()}
    assert kept == {"run.json", "scores.parquet", "answers.parquet", "seals.jsonl"}
    assert not (folder / "run.json").exists()
    assert "2 answers made again" in _replay("1", "--verify")  # from its new place
    _call("--scored", "--cases", "1", "--resume", "--out", "next", "--page", "docs/proof.md")
    assert msgspec.json.decode((folder / "run.json").read_bytes())["run"] == 2  # nothing was resumed
    assert "one core only" in (checkout / "docs/proof.md").read_text()


def test_a_run_is_closed_once_and_with_a_reason(checkout: Path) -> None:
    with pytest.raises(DiagnosisError, match="with a reason"):
        _close(" ")
    _close("over")
    with pytest.raises(DiagnosisError, match="nothing to close"):
        _close("again")
    assert _log(checkout) == ["started", "finished", "closed"]
