"""Starting, resuming and logging a run; a scored one follows the committed diagnosis and nothing else."""

import subprocess
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.cases import CaseSpec
from fricomp.sim_bench.studies.proof import (
    PlannedCase,
    RunSettings,
    append_entry,
    check_diagnosis,
    format_earlier,
    load_or_start,
    log_outcome,
    next_run,
    plan_run,
    read_entries,
    require_plan,
    watch,
)
from fricomp.sim_bench.studies.proof import settings as run_settings
from fricomp.sim_bench.studies.proof.making import name_of
from fricomp.sim_bench.studies.proof.seal import SealBook


def _git(folder: Path, *arguments: str) -> None:
    identity = ("-c", "user.name=test", "-c", "user.email=test@example.org")
    subprocess.run(["git", "-C", str(folder), *identity, *arguments], check=True, capture_output=True)


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    source = tmp_path / "repository" / "sim_bench" / "diagnosis" / "search.py"
    source.parent.mkdir(parents=True)
    source.write_text("threshold = 1\n")
    for name in ("concealed", "proof"):
        (source.parents[1] / name).mkdir()
        (source.parents[1] / name / "code.py").write_text(f"{name} = 1\n")
    _git(tmp_path / "repository", "init", "-q")
    _git(tmp_path / "repository", "add", ".")
    _git(tmp_path / "repository", "commit", "-q", "-m", "diagnosis")
    monkeypatch.setattr(run_settings, "imported_diagnosis", source.parent.resolve)
    return tmp_path / "repository"


def _start(tmp_path: Path, repository: Path, name: str = "run", *, resume: bool = False, cases: int = 8) -> RunSettings:
    wanted = RunSettings(cases, scored=True)
    log = tmp_path / "runs.jsonl"
    return load_or_start(tmp_path / name, wanted, resume=resume, log=log, repository=repository)


def _designs(planned: Iterable[PlannedCase]) -> list[CaseSpec]:
    return [replace(each.spec, seed=0) for each in planned if isinstance(each.spec, CaseSpec)]


def test_a_scored_run_is_logged_before_it_starts_and_once_more_for_each_end(tmp_path: Path, repository: Path) -> None:
    settings, log = _start(tmp_path, repository), tmp_path / "runs.jsonl"
    assert [entry["event"] for entry in read_entries(log)] == ["started"]
    log_outcome(settings, log, 3, 5, {"x": "1"})
    assert _start(tmp_path, repository, resume=True) == settings
    log_outcome(settings, log, 0, 8, {"x": "2"})
    assert [(e["event"], e["run"]) for e in read_entries(log)] == [("started", 1), ("paused", 1), ("finished", 1)]
    assert _start(tmp_path, repository, "another").run == 2


def test_a_resumed_run_keeps_its_seeds_and_may_grow(tmp_path: Path, repository: Path) -> None:
    def start(cases: int, *, resume: bool = False) -> RunSettings:
        wanted = RunSettings(cases, first_seed=5)
        return load_or_start(tmp_path / "run", wanted, resume=resume, log=tmp_path / "log", repository=repository)

    first = start(8)
    assert list(plan_run(start(12, resume=True)))[:8] == list(plan_run(first))
    with pytest.raises(DiagnosisError, match="give --resume"):
        start(8)


@pytest.mark.parametrize("cases", [7, 12])
def test_a_scored_run_keeps_to_its_number_of_cases(tmp_path: Path, repository: Path, cases: int) -> None:
    _start(tmp_path, repository)
    with pytest.raises(DiagnosisError, match="begun with 8 cases"):
        _start(tmp_path, repository, resume=True, cases=cases)


def test_a_scored_run_does_not_go_on_by_another_plan(tmp_path: Path, repository: Path) -> None:
    run, other = (_start(tmp_path, repository, name) for name in ("run", "another"))
    SealBook(tmp_path / "run" / "seals.jsonl").seal(name_of(plan_run(run)[0].spec), b"answer")
    require_plan(plan_run(run), run, tmp_path / "run")
    with pytest.raises(DiagnosisError, match="not in the plan"):
        require_plan(plan_run(other), run, tmp_path / "run")


def test_two_scored_runs_do_not_begin_with_the_same_designs(tmp_path: Path, repository: Path) -> None:
    one, other = (plan_run(_start(tmp_path, repository, name, cases=60)) for name in ("run", "another"))
    assert sum(a == b for a, b in zip(_designs(one), _designs(other), strict=True)) <= 5


def test_a_scored_run_stops_when_the_diagnosis_is_another(tmp_path: Path, repository: Path) -> None:
    settings = _start(tmp_path, repository)
    go_on = watch(settings, repository)
    assert go_on()
    (repository / "sim_bench" / "diagnosis" / "search.py").write_text("threshold = 2\n")
    with pytest.raises(DiagnosisError, match="commit it before a scored run"):
        go_on()
    _git(repository, "commit", "-q", "-a", "-m", "another")
    with pytest.raises(DiagnosisError, match="start a new one"):
        go_on()


def test_a_checkout_whose_diagnosis_is_not_the_one_that_runs_is_refused(
    tmp_path: Path, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_settings, "imported_diagnosis", lambda: tmp_path / "elsewhere" / "sim_bench" / "diagnosis")
    with pytest.raises(DiagnosisError, match="elsewhere"):
        _start(tmp_path, repository)
    assert not (tmp_path / "runs.jsonl").exists()


def test_a_development_run_goes_on_with_its_own_diagnosis_only(tmp_path: Path, repository: Path) -> None:
    wanted = RunSettings(3)
    run = load_or_start(tmp_path / "run", wanted, resume=False, log=tmp_path / "log", repository=repository)
    check_diagnosis(run, repository)
    (repository / "sim_bench" / "diagnosis" / "search.py").write_text("threshold = 2\n")
    _git(repository, "commit", "-q", "-a", "-m", "another")
    with pytest.raises(DiagnosisError, match="start a new one"):
        check_diagnosis(run, repository)


def test_time_that_is_over_stops_a_run(tmp_path: Path) -> None:
    assert not watch(RunSettings(3), tmp_path, 0.0)()
    assert watch(RunSettings(3), tmp_path, 10.0)()


def test_earlier_runs_stand_in_the_page_with_their_figures_and_why_they_ended(tmp_path: Path) -> None:
    log = tmp_path / "runs.jsonl"
    for run, name in ((1, "first"), (2, "second")):
        append_entry(log, {"run": run, "tree": name * 4, "event": "started", "cases": 9})
    figures = {"right name, rich motion, ENR ≥ 0.2": "76.2% (16 of 21; 52.8% to 91.8%)"}
    append_entry(log, {"run": 1, "tree": "first" * 4, "event": "paused", "cases": 30, "left": 1, "figures": figures})
    append_entry(log, {"run": 1, "tree": "first" * 4, "event": "closed", "reason": "a better diagnosis"})
    first, second = format_earlier(read_entries(log), 3).splitlines()[-4:-2]
    assert first == "| 1 | `firstfirstfi` | 30 | – | 76.2%, 16 of 21 | – | – | – | a better diagnosis |"
    assert second == "| 2 | `secondsecond` | 0 | – | – | – | – | – | – |"
    assert format_earlier(read_entries(log), 1) == ""
    assert next_run(log) == 3


def test_a_scored_run_stops_when_the_generator_is_another(tmp_path: Path, repository: Path) -> None:
    settings = _start(tmp_path, repository)
    check_diagnosis(settings, repository)
    generator = repository / "sim_bench" / "concealed"
    (generator / "another.py").write_text("gravity = 9.81\n")
    _git(repository, "add", "-A")
    _git(repository, "commit", "-q", "-m", "another generator")
    with pytest.raises(DiagnosisError, match="sim_bench/cases"):
        check_diagnosis(settings, repository)
