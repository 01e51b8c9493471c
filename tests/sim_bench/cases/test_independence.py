"""Generators stand on their own: what they import, directly or not, holds none of what it is to prove."""

import ast
from pathlib import Path

import grimp
import pytest

import fricomp.sim_bench.cases as cases
import fricomp.sim_bench.studies.second_generator as second

_FORBIDDEN = (
    "fricomp.laws",
    "fricomp.model",
    "fricomp.recording",
    "fricomp.calibration",
    "fricomp.control",
    "fricomp.diagnosis",
    "fricomp.sim_bench.stand_in",
)

_SECOND = "fricomp.sim_bench.studies.second_generator"
_KIT = "fricomp.sim_bench.studies.kit"
_MAKING = ("joint", "motion", "law", "hidden", "effect", "physics", "flaws", "outside", "effects", "record", "cases")


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("fricomp", cache_dir=None)


@pytest.mark.parametrize("forbidden", _FORBIDDEN)
def test_no_chain_of_imports_leads_from_the_generator_to(forbidden: str, graph: grimp.ImportGraph) -> None:
    if forbidden not in graph.modules:
        pytest.skip(f"{forbidden} is not installed")
    chain = graph.find_shortest_chain("fricomp.sim_bench.cases", forbidden, as_packages=True)
    assert chain is None


def test_the_diagnosis_does_not_import_the_generator(graph: grimp.ImportGraph) -> None:
    if "fricomp.diagnosis" not in graph.modules:
        pytest.skip("fricomp.diagnosis is not installed")
    downstream = graph.find_downstream_modules("fricomp.sim_bench.cases", as_package=True)
    assert not [name for name in downstream if name.startswith("fricomp.diagnosis")]


def test_the_generator_imports_of_the_library_only_its_errors_and_how_files_are_written() -> None:
    folder = Path(cases.__file__).parent
    imported = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 0 and (node.module or "").startswith("fricomp"):
                imported.add(node.module)
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names if alias.name.startswith("fricomp")}
    assert imported == {"fricomp.errors", "fricomp.whole_file"}


@pytest.mark.parametrize("module", _MAKING)
def test_no_chain_of_imports_leads_from_the_second_generator_to_the_first_or_the_diagnosis(
    module: str, graph: grimp.ImportGraph
) -> None:
    for forbidden in {*_FORBIDDEN, "fricomp.sim_bench.cases", "fricomp.sim_bench.studies.proof"} - {
        "fricomp.recording"
    }:
        upstream = graph.find_upstream_modules(f"{_SECOND}.{module}")
        assert not [name for name in upstream if name.startswith(forbidden)]


def test_what_scores_the_second_generator_takes_only_the_kit_of_all_studies(graph: grimp.ImportGraph) -> None:
    names = {path.stem for path in Path(second.__file__).parent.glob("*.py")} - {"__init__"}
    direct = {other for name in names for other in graph.find_modules_directly_imported_by(f"{_SECOND}.{name}")}
    beside = {name for name in direct if name.startswith("fricomp.sim_bench") and not name.startswith(_SECOND)}
    assert all(name.startswith(_KIT) for name in beside)


def test_the_kit_of_the_studies_imports_no_generator(graph: grimp.ImportGraph) -> None:
    for module in graph.find_descendants(_KIT):
        direct = graph.find_modules_directly_imported_by(module)
        assert not [name for name in direct if name.startswith("fricomp.sim_bench") and not name.startswith(_KIT)]


def test_the_diagnosis_does_not_import_the_second_generator(graph: grimp.ImportGraph) -> None:
    downstream = graph.find_downstream_modules(_SECOND, as_package=True)
    assert not [name for name in downstream if name.startswith("fricomp.diagnosis")]
