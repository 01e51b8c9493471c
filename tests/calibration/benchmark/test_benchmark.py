import json
import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.benchmark.ledger import Ledger
from fricomp.calibration.benchmark.oracle import find_optimum
from fricomp.calibration.benchmark.printed import NOISE_FREE, NOISY
from fricomp.calibration.benchmark.problem import PaperProblem
from fricomp.calibration.benchmark.study import run_noise_free, run_outliers, run_statistics
from fricomp.calibration.benchmark.summary import summarise_statistics


def test_two_printed_averages_do_not_follow_from_the_printed_values() -> None:
    rows = {("none", row.method): row for row in NOISE_FREE} | {("5 %", row.method): row for row in NOISY}
    off = {("none", "PINN"): 0.4545, ("5 %", "GA"): 4.3897}
    for key, row in rows.items():
        assert row.recomputed().mean() == pytest.approx(off.get(key, row.average), rel=0.003)
        assert (abs(row.recomputed().mean() / row.average - 1.0) > 0.03) == (key in off)


def test_a_study_goes_on_where_it_stopped(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path / "ledger.jsonl")
    said: list[str] = []
    run_statistics(ledger, 1, said.append)
    run_statistics(Ledger(ledger.path), 1, said.append)
    assert len(said) == 2
    figures = summarise_statistics(ledger, "absolute")
    assert figures is not None
    assert figures.draws == figures.converged == 1
    assert figures.largest_distance < 0.02
    assert figures.largest_excess < 1e-3


def test_a_half_written_line_is_left_out_and_does_not_spoil_the_next(tmp_path: Path) -> None:
    path = tmp_path / "ledger.jsonl"
    path.write_text('{"study": "x", "seed": 1}\n{"study": "x", "se')
    ledger = Ledger(path)
    assert list(ledger.missing(range(3), study="x")) == [0, 2]
    ledger.append({"study": "x", "seed": np.int64(2)})
    assert [row["seed"] for row in Ledger(path).rows(study="x")] == [1, 2]


def test_page_figures_and_pictures_come_from_the_ledger(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from fricomp.calibration.benchmark.publication import publish

    ledger = Ledger(tmp_path / "ledger.jsonl")
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


@pytest.mark.slow
def test_swarm_ends_at_the_oracle_and_never_below_it() -> None:
    pytest.importorskip("numba")
    from fricomp.calibration.benchmark.compiled_search import run_compiled

    draw = PaperProblem().draw("absolute", 0)
    best = find_optimum(draw).negative_log_likelihood
    for method in ("PSO", "GA"):
        found = run_compiled(method, draw, 2000, 0)
        assert -1e-6 < found.negative_log_likelihood - best < 0.1
