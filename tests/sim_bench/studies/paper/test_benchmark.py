import json
import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.sim_bench.studies.kit.page import fill_template
from fricomp.sim_bench.studies.kit.store import RowStore
from fricomp.sim_bench.studies.paper.oracle import find_optimum
from fricomp.sim_bench.studies.paper.printed import NOISE_FREE, NOISY
from fricomp.sim_bench.studies.paper.problem import NOISE_READINGS, PaperProblem
from fricomp.sim_bench.studies.paper.rival_summary import summarise_noise_free
from fricomp.sim_bench.studies.paper.study import (
    SPREADS,
    draw_random_values,
    run_as_given,
    run_noise_free,
    run_outliers,
    run_statistics,
)
from fricomp.sim_bench.studies.paper.summary import summarise_outliers, summarise_statistics


def test_two_printed_averages_do_not_follow_from_the_printed_values() -> None:
    rows = {("none", row.method): row for row in NOISE_FREE} | {("5 %", row.method): row for row in NOISY}
    off = {("none", "PINN"): 0.4545, ("5 %", "GA"): 4.3897}
    for key, row in rows.items():
        assert row.recomputed().mean() == pytest.approx(off.get(key, row.average), rel=0.003)
        assert (abs(row.recomputed().mean() / row.average - 1.0) > 0.03) == (key in off)


def test_a_study_goes_on_where_it_stopped(tmp_path: Path) -> None:
    ledger = RowStore(tmp_path / "ledger.jsonl")
    said: list[str] = []
    run_statistics(ledger, 1, said.append)
    run_statistics(RowStore(ledger.path), 1, said.append)
    assert len(said) == 2
    figures = summarise_statistics(ledger, "absolute")
    assert figures is not None
    assert figures.draws == figures.converged == figures.from_projection == 1
    assert figures.largest_distance < 0.02
    assert figures.largest_excess < 1e-3


def test_page_figures_and_pictures_come_from_the_ledger(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from fricomp.sim_bench.studies.paper.publication import publish

    ledger = RowStore(tmp_path / "ledger.jsonl")
    run_noise_free(ledger, 1, lambda _: None)
    run_statistics(ledger, 1, lambda _: None)
    run_outliers(ledger, 1, lambda _: None)
    publish(ledger, [tmp_path / "page.md"], "the command")
    text, figures = (tmp_path / "page.md").read_text(), json.loads((tmp_path / "page" / "figures.json").read_text())
    assert "`the command`" in text
    assert figures["pinn"]["relative"]["draws"] == 1
    pictures = re.findall(r"\]\((page/[a-z-]+\.png)\)", text)
    assert sorted(pictures) == sorted(f"page/{path.name}" for path in (tmp_path / "page").glob("*.png"))
    distance = next(target for target in figures["targets"] if "oracle" in target["what"])
    assert distance["reached"] is True


def test_a_training_alone_reaches_the_parameters_from_starts_within_a_factor_of_three(tmp_path: Path) -> None:
    ledger = RowStore(tmp_path / "ledger.jsonl")
    run_noise_free(ledger, 1, lambda _: None)
    run_as_given(ledger, 3, lambda _: None)
    ours = {f.starts: f for f in summarise_noise_free(ledger)}
    assert ours["all eight, factor 3"].runs == ours["all eight, factor 3"].below_one == 3
    assert ours["all eight, factor 3"].largest_error < 1e-3
    assert ours["all eight, factor 30"].runs == 3
    assert ours["a Stribeck velocity, factor 30"].from_start == 1


def test_random_starts_leave_a_slope_in_the_stribeck_velocity() -> None:
    starts = np.array([draw_random_values(seed, spread) for seed in range(20) for spread in SPREADS])
    assert np.all(starts[:, [1, 5]] > starts[:, [0, 4]])


def test_trainings_by_adam_from_several_starts_share_nothing() -> None:
    pytest.importorskip("torch")
    from fricomp.sim_bench.studies.paper.adam import run_adam

    draw, starts = PaperProblem().draw("none", 0), np.array([draw_random_values(seed, 3.0) for seed in range(3)])
    once, again = run_adam(draw, starts[[0, 1]], 20), run_adam(draw, starts[[0, 2]], 20)
    np.testing.assert_allclose(once[0].course, again[0].course, rtol=1e-12)
    assert once[0].fitness[-1, 1] < once[0].fitness[0, 1]
    assert np.max(np.abs(once[1].values - again[1].values)) > 0.01


def test_adam_with_noise_starts_from_its_best_start_and_stands_beside_ours_on_the_same_draw(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    from fricomp.sim_bench.studies.paper.rivals import run_adam_study

    ledger = RowStore(tmp_path / "ledger.jsonl")
    for _ in range(2):
        run_adam_study(ledger, 3, 2, lambda _: None)
    assert [row["seed"] for row in ledger.rows(reading="none", spread=SPREADS[1])] == [0, 1, 2]
    best = min(
        ledger.rows(reading="none"), key=lambda row: PaperProblem().error_percent(np.array(row["values"])).mean()
    )
    for reading in NOISE_READINGS:
        (row,) = ledger.rows(reading=reading)
        assert row["seed"] == 0
        start = draw_random_values(best["seed"], best["spread"])
        assert np.max(np.abs(np.array(row["course"][-1]) - start)) < 0.01


@pytest.mark.slow
def test_outliers_leave_intervals_of_the_robust_fit_that_mostly_hold_the_truth(tmp_path: Path) -> None:
    ledger = RowStore(tmp_path / "ledger.jsonl")
    run_outliers(ledger, 10, lambda _: None)
    for reading in NOISE_READINGS:
        figures = summarise_outliers(ledger, reading)
        assert figures is not None
        assert figures.draws == 10
        assert np.mean(figures.coverage) > 0.8


@pytest.mark.slow
def test_swarm_ends_at_the_oracle_and_never_below_it() -> None:
    pytest.importorskip("numba")
    from fricomp.sim_bench.studies.paper.compiled_search import run_compiled

    draw = PaperProblem().draw("absolute", 0)
    best = find_optimum(draw).negative_log_likelihood
    for method in ("PSO", "GA"):
        found = run_compiled(method, draw, 2000, 0)
        assert -1e-6 < found.negative_log_likelihood - best < 0.1


def test_what_the_page_says_beside_its_figures_is_what_its_source_says() -> None:
    page = Path(__file__).parents[4] / "docs" / "identification.md"
    assert page.read_text(encoding="utf-8").endswith(fill_template("paper/closing.md"))
