"""Starting and resuming a run; the cases of a scored one follow from a number that is drawn as it begins."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.cases import CaseSpec
from fricomp.sim_bench.studies.proof import (
    PlannedCase,
    RunSettings,
    load_or_start,
    load_replay,
    plan_run,
    settings,
    stop_after,
)


def _start(folder: Path, *, resume: bool = False, cases: int = 8) -> RunSettings:
    return load_or_start(folder, RunSettings(cases, scored=True), resume=resume)


def _designs(planned: Iterable[PlannedCase]) -> list[CaseSpec]:
    return [replace(each.spec, seed=0) for each in planned if isinstance(each.spec, CaseSpec)]


def test_the_number_of_a_scored_run_is_drawn_once_and_written_down(tmp_path: Path) -> None:
    first = _start(tmp_path / "run")
    assert first.key
    assert _start(tmp_path / "run", resume=True) == first
    assert _start(tmp_path / "another").key != first.key


def test_a_resumed_run_keeps_its_seeds_and_may_grow(tmp_path: Path) -> None:
    def start(cases: int, *, resume: bool = False) -> RunSettings:
        return load_or_start(tmp_path / "run", RunSettings(cases, first_seed=5), resume=resume)

    first = start(8)
    assert list(plan_run(start(12, resume=True)))[:8] == list(plan_run(first))
    with pytest.raises(DiagnosisError, match="give --resume"):
        start(8)


@pytest.mark.parametrize("cases", [7, 12])
def test_a_scored_run_keeps_to_its_number_of_cases(tmp_path: Path, cases: int) -> None:
    _start(tmp_path / "run")
    with pytest.raises(DiagnosisError, match="began with 8 cases"):
        _start(tmp_path / "run", resume=True, cases=cases)


def test_two_scored_runs_do_not_begin_with_the_same_designs(tmp_path: Path) -> None:
    one, other = (plan_run(_start(tmp_path / name, cases=60)) for name in ("run", "another"))
    assert sum(a == b for a, b in zip(_designs(one), _designs(other), strict=True)) <= 5


def test_a_run_names_every_commit_at_which_it_went_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for commit in ("aaa", "bbb", "bbb"):
        monkeypatch.setattr(settings, "find_commit", lambda commit=commit: commit)
        found = _start(tmp_path / "run", resume=True)
    assert found.commits == ("aaa", "bbb")


def test_a_replay_has_the_cases_of_the_run_in_a_folder_of_its_own(tmp_path: Path) -> None:
    run = _start(tmp_path / "run")
    again = load_replay(tmp_path / "run", tmp_path / "again", 3)
    assert list(plan_run(again)) == list(plan_run(run))[:3]
    assert load_replay(tmp_path / "run", tmp_path / "again").cases == 8
    with pytest.raises(DiagnosisError, match="holds another run"):
        load_replay(tmp_path / "run", tmp_path / "run")
    with pytest.raises(DiagnosisError, match=r"holds no run\.json"):
        load_replay(tmp_path, tmp_path / "other")


def test_time_that_is_over_stops_a_run() -> None:
    assert not stop_after(0.0)()
    assert stop_after(10.0)()
    assert stop_after(None)()
