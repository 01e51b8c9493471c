"""Other methods on concealed cases: what they are given, and that none of it holds the answer."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from fricomp.fleet import SerialExecutor
from fricomp.sim_bench.cases import CaseSpec, generate, write_case
from fricomp.sim_bench.studies.proof import PlannedCase
from fricomp.sim_bench.studies.proof.baselines import METHODS, compare_baselines, format_table
from fricomp.sim_bench.studies.proof.baselines.data import BaselineData, fit_columns, load_data
from fricomp.sim_bench.studies.proof.baselines.library import build_library
from fricomp.sim_bench.studies.proof.baselines.methods import fit_base
from tests.sim_bench.studies.proof.scoring import score_of


@pytest.fixture(scope="module")
def null(tmp_path_factory: pytest.TempPathFactory) -> BaselineData:
    spec = CaseSpec(5, excitation="fourier", duration=20.0, noise="white", core="dahl", family="harmonic")
    return load_data(write_case(generate(spec), tmp_path_factory.mktemp("null")))


def test_the_refitted_rigid_joint_explains_a_joint_with_nothing_missing(null: BaselineData) -> None:
    assert fit_base(null).error < 0.02 * np.std(null.torque)


def test_no_regressor_holds_the_torque_that_it_is_to_explain(null: BaselineData) -> None:
    before = fit_base(null).error
    for name, columns in build_library(null).items():
        assert fit_columns(null, np.hstack([null.base, columns])) > 0.7 * before, name


def test_the_right_term_closes_the_gap_of_its_effect(tmp_path: Path) -> None:
    spec = CaseSpec(5, ("quadratic_drag",), "5", "fourier", 20.0, "white", "dahl", "harmonic")
    data = load_data(write_case(generate(spec), tmp_path))
    right = np.hstack([data.base, build_library(data)["quadratic_drag"]])
    assert fit_columns(data, right) < 0.97 * fit_base(data).error


@pytest.mark.slow
def test_all_methods_answer_and_their_table_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planned = [
        PlannedCase("null", CaseSpec(5, excitation="fourier", duration=12.0, family="harmonic")),
        PlannedCase("single", CaseSpec(6, ("load_coulomb",), "5", "fourier", 12.0, family="harmonic")),
    ]
    scores = compare_baselines(planned[:1], tmp_path, (SerialExecutor(), 1))
    (store,) = tmp_path.iterdir()
    written, compared = store.read_bytes(), list[PlannedCase]()
    module = import_module("fricomp.sim_bench.studies.proof.baselines.compare")
    compare = module._compare_case

    def count(planned: PlannedCase) -> object:
        compared.append(planned)
        return compare(planned)

    monkeypatch.setattr(module, "_compare_case", count)
    scores = compare_baselines(planned, tmp_path, (SerialExecutor(), 1))
    assert len(scores) == 2 * len(METHODS)
    assert store.read_bytes().startswith(written)
    assert compared == planned[1:]  # what is compared is not compared again
    table = format_table(scores, [], "Measured on a day.")
    assert "Measured on a day." in table
    shared = format_table(scores, [score_of(case=scores[0].case), score_of(case="another")], "")
    assert "1 cases, the same for all" in shared
    assert "| **fricomp diagnose** |" in shared
    assert all(f"| {method} |" in table for method in METHODS)
    assert all(np.isfinite(score.error) for score in scores)
