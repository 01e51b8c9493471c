"""Whole runs with diagnoses whose answers are known."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.fleet import SerialExecutor, open_executor
from fricomp.sim_bench.cases import CaseSpec
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.proof import (
    PlannedCase,
    RunSettings,
    count_open,
    format_failures,
    keep_data,
    list_development_seeds,
    load_or_start,
    measure_speed_up,
    plan_cases,
    read_refused,
    read_scores,
    restore_data,
    run_proof,
    write_page,
)
from fricomp.sim_bench.studies.proof.making import name_case, prepare
from tests.sim_bench.studies.proof.answering import always_cogging, always_consistent, answer, dies_once

_PLANNED = [
    PlannedCase("null", CaseSpec(1, duration=6.0)),
    PlannedCase("single", CaseSpec(2, ("cogging",), "2", duration=6.0)),
    PlannedCase("single", CaseSpec(3, ("load_coulomb",), "2", duration=6.0)),
]


def test_a_run_whose_time_is_over_finishes_what_it_began_and_goes_on_later(tmp_path: Path) -> None:
    allowed = iter([True, True])
    pool = (SerialExecutor(), 1)
    scores = run_proof(
        _PLANNED, tmp_path, pool, salt="s", diagnose=always_consistent, go_on=lambda: next(allowed, False)
    )
    assert [score.case for score in scores] == sorted(name_case(each.spec) for each in _PLANNED[:2])
    assert count_open(_PLANNED, tmp_path) == 1
    assert len(run_proof(_PLANNED, tmp_path, pool, salt="s", diagnose=always_consistent)) == 3
    assert count_open(_PLANNED, tmp_path) == 0


def test_a_run_goes_on_from_the_data_beside_its_page(tmp_path: Path) -> None:
    first, kept, second = (tmp_path / name for name in ("first", "proof", "second"))
    settings = load_or_start(first, RunSettings(3), resume=False)
    allowed, pool = iter([True, True]), (SerialExecutor(), 1)
    begun = run_proof(
        _PLANNED, first, pool, salt=settings.salt, diagnose=always_consistent, go_on=lambda: next(allowed, False)
    )
    keep_data(first, kept)
    restore_data(kept, second)
    again = load_or_start(second, RunSettings(3), resume=True)
    assert again == settings
    assert str(read_scores(second)) == str(begun)  # not all numbers equal themselves
    assert count_open(_PLANNED, second) == 1
    assert len(run_proof(_PLANNED, second, pool, salt=again.salt, diagnose=always_cogging)) == 3
    assert (second / "seals.jsonl").read_text().startswith((first / "seals.jsonl").read_text())
    restore_data(kept, second)  # a run that is there stays
    keep_data(second, second)  # a page of the same name beside its run
    assert count_open(_PLANNED, second) == 0


@pytest.mark.slow
def test_one_worker_is_timed_against_several() -> None:
    found = measure_speed_up(_PLANNED[:1], 1, diagnose=always_consistent)
    assert len(found.one) == len(found.one_core) == len(found.several) == len(found.loops) == 1
    assert min(*found.one, *found.one_core, *found.several, *found.loops) > 0.0
    assert len(os.sched_getaffinity(0)) == found.cores
    assert "times as fast as one" in str(found)
    assert "load average" in str(found)


def test_a_run_scores_what_it_was_told(tmp_path: Path) -> None:
    scores = run_proof(_PLANNED, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=always_cogging)
    by_truth = {score.truth: score for score in scores}
    assert by_truth["cogging"].top_right
    assert by_truth["load_coulomb"].false_names == 1
    assert by_truth[""].false_names == 1
    assert read_scores(tmp_path) == scores or len(read_scores(tmp_path)) == 3


def test_every_answer_is_sealed_before_its_diagnosis_starts(tmp_path: Path) -> None:
    sealed_at_start: list[int] = []

    def diagnose(files: dict[str, bytes]) -> BlindAnswer:
        sealed_at_start.append(len((tmp_path / "seals.jsonl").read_text().splitlines()))
        return answer("consistent")

    run_proof(_PLANNED, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=diagnose)
    assert all(sealed >= done + 1 for done, sealed in enumerate(sealed_at_start))


def test_the_diagnosis_gets_what_a_user_has_and_no_more(tmp_path: Path) -> None:
    seen: list[set[str]] = []

    def diagnose(files: dict[str, bytes]) -> BlindAnswer:
        seen.append(set(files))
        assert not any(b"load_coulomb" in content or b"cogging" in content for content in files.values())
        return answer("consistent")

    run_proof(_PLANNED, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=diagnose)
    usual = {"recording.parquet", "joint.xml", "loop.toml"}
    assert all(files in (usual, usual | {"friction.json"}) for files in seen)
    assert len(seen) == 3


def test_a_stopped_run_goes_on_where_it_was(tmp_path: Path) -> None:
    calls: list[int] = []

    def stops(files: dict[str, bytes]) -> BlindAnswer:
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return answer("consistent")

    with pytest.raises(KeyboardInterrupt):
        run_proof(_PLANNED, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=stops)
    finished = len(read_scores(tmp_path))
    assert 1 <= finished < 3
    scores = run_proof(_PLANNED, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=stops)
    assert len(scores) == 3
    assert len(calls) == 3 + (3 - finished)  # what is scored is not diagnosed again
    assert len((tmp_path / "seals.jsonl").read_text().splitlines()) == 3


def test_an_answer_that_was_changed_after_sealing_is_not_scored(tmp_path: Path) -> None:
    def tampers(files: dict[str, bytes]) -> BlindAnswer:
        path = tmp_path / "answers" / f"{name_case(_PLANNED[0].spec)}.json"
        record = json.loads(path.read_text())
        path.write_text(json.dumps(record | {"verdict": "missing_physics"}))
        return answer("consistent")

    with pytest.raises(DiagnosisError, match="does not match its seal"):
        run_proof(_PLANNED[:1], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=tampers)


def test_threads_and_one_worker_score_the_same(tmp_path: Path) -> None:
    alone = run_proof(_PLANNED, tmp_path / "a", (SerialExecutor(), 1), salt="s", diagnose=always_cogging)
    with ThreadPoolExecutor(2) as pool:
        shared = run_proof(_PLANNED, tmp_path / "b", (pool, 2), salt="s", diagnose=always_cogging)
    assert [(s.case, s.named, s.enr) for s in alone] == [(s.case, s.named, s.enr) for s in shared]


def test_salts_make_answers_of_the_same_case_look_different() -> None:
    first, second = (prepare(_PLANNED[0].spec, salt) for salt in ("one", "two"))
    assert first.answer != second.answer
    assert first.files["recording.parquet"] == second.files["recording.parquet"]


def test_a_case_that_cannot_be_made_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fricomp.sim_bench.studies.proof import making

    def refuse(spec: CaseSpec) -> None:
        raise DiagnosisError("unstable")

    monkeypatch.setattr(making, "generate", refuse)
    reported: list[object] = []
    with pytest.raises(DiagnosisError, match="no scores"):
        run_proof(
            _PLANNED[:1], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=always_cogging, progress=reported.append
        )
    assert reported == [None]
    assert list(read_refused(tmp_path).values()) == ["unstable"]
    assert count_open(_PLANNED[:1], tmp_path) == 0


def test_a_diagnosis_that_is_lost_is_an_answer_that_failed(tmp_path: Path) -> None:
    def lost(files: dict[str, bytes]) -> BlindAnswer:
        raise MemoryError("the cluster gave up")

    (score,) = run_proof(_PLANNED[:1], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=lost)
    assert score.verdict == "failed"
    assert score.error == "MemoryError: the cluster gave up"
    assert not read_refused(tmp_path)


def test_an_installation_that_makes_no_case_ends_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module that does not import would have every case refused, one after the other."""

    def missing(spec: CaseSpec, salt: str) -> None:
        raise ModuleNotFoundError("No module named 'numba'")

    monkeypatch.setattr("fricomp.sim_bench.studies.proof.run.prepare", missing)
    with pytest.raises(ModuleNotFoundError, match="numba"):
        run_proof(_PLANNED[:1], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=always_consistent)
    assert not read_refused(tmp_path)


@pytest.mark.usefixtures("drawn_charts")
def test_page_and_list_of_failures_are_written(tmp_path: Path) -> None:
    scores = run_proof(_PLANNED, tmp_path / "run", (SerialExecutor(), 1), salt="s", diagnose=always_cogging)
    page = tmp_path / "docs" / "proof.md"
    page.parent.mkdir()
    write_page(scores, page, title="A test.", reproduce="fricomp bench mismatch --quick")
    text = page.read_text()
    assert "where nothing is missing" in text
    assert "100.0% (1 of 1" in text
    assert "outside the catalogue called unknown" not in text  # there is no such case
    assert not (page.parent / "proof" / "power.png").exists()  # it would be a single point
    assert "](proof/details.md)" in text
    details = (page.parent / "proof" / "details.md").read_text()
    assert details.startswith("# Details of the proof on concealed cases\n\nA test.\n\n## How a run goes")
    assert "## Wrong answers\n\n2 of 3 answers" in details
    assert (page.parent / "proof" / "confusion.png").stat().st_size > 5000
    failures = format_failures(scores)
    assert "fricomp cases make --seed 3 --effect load_coulomb" in failures
    assert failures.startswith("# 2 wrong answers of 3")


def test_an_unknown_executor_is_named_with_the_valid_ones() -> None:
    with pytest.raises(DiagnosisError, match="valid are"), open_executor("cloud://x"):
        pass


def test_a_proposed_motion_whose_recording_fails_is_no_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(spec: object, motion: bytes) -> None:
        raise RuntimeError("the joint is gone")

    def asking(files: dict[str, bytes]) -> BlindAnswer:
        unsure = json.loads(answer("missing_physics", ["cogging"]).diagnosis)
        unsure["effects"][0]["indistinguishable_from"] = ["kinematic_error"]
        return BlindAnswer(json.dumps(unsure).encode(), b"time\n0\n", 1.0, "")

    monkeypatch.setattr("fricomp.sim_bench.studies.proof.run.prepare_follow_up", fail)
    (score,) = run_proof(_PLANNED[1:2], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=asking)
    assert (score.proposed, score.recorded, score.resolved) == (True, False, False)
    assert score.top_right


def test_a_proposed_motion_is_recorded_and_diagnosed_with_the_first(tmp_path: Path) -> None:
    seen: list[set[str]] = []

    def cannot_tell_first(files: dict[str, bytes]) -> BlindAnswer:
        seen.append(set(files))
        if "recording_2.parquet" in files:
            return answer("missing_physics", ["cogging"])
        unsure = json.loads(answer("missing_physics", ["kinematic_error"]).diagnosis)
        unsure["effects"][0]["indistinguishable_from"] = ["cogging"]
        rows = [f"{0.01 * k},{0.002 * k},0.2" for k in range(300)]
        motion = "\n".join(["time,position_reference,velocity_reference", *rows]).encode()
        return BlindAnswer(json.dumps(unsure).encode(), motion, 1.0, "")

    scores = run_proof(_PLANNED[1:2], tmp_path, (SerialExecutor(), 1), salt="s", diagnose=cannot_tell_first)
    assert seen[1] - seen[0] == {"recording_2.parquet"}
    assert scores[0].in_set
    assert not scores[0].top_right  # what is scored is the first answer
    assert scores[0].proposed
    assert scores[0].resolved


@pytest.mark.slow
def test_processes_score_like_one(tmp_path: Path) -> None:
    with open_executor("processes://2") as pool:
        scores = run_proof(_PLANNED, tmp_path, pool, salt="s", diagnose=always_consistent)
    assert [score.verdict for score in scores] == ["consistent"] * 3


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # dask.distributed warns on its own shutdown
def test_a_killed_worker_of_a_dask_cluster_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setenv("FRICOMP_TEST_MARKER", str(tmp_path / "dead"))
    with open_executor("dask://local:2") as pool:
        scores = run_proof(_PLANNED, tmp_path / "run", pool, salt="s", diagnose=dies_once)
    assert (tmp_path / "dead").exists()
    assert len(scores) == 3


def test_a_plan_runs_from_its_seeds(tmp_path: Path) -> None:
    planned = plan_cases(2, list_development_seeds(40), 6.0)
    scores = run_proof(planned, tmp_path, (SerialExecutor(), 1), salt="s", diagnose=always_consistent)
    assert {int(score.seed) for score in scores} == {40, 41}


def test_the_blind_side_imports_nothing_of_the_generator() -> None:
    module = "fricomp.sim_bench.studies.kit.blind_diagnosis"
    code = f"import sys, {module} as _; print([name for name in sys.modules if '.cases' in name])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
