"""The generator stands on its own: what it imports, directly or not, holds none of what it is to prove."""

import ast
from pathlib import Path

import grimp
import pytest

import fricomp.sim_bench.concealed as concealed

_FORBIDDEN = (
    "fricomp.laws",
    "fricomp.model",
    "fricomp.recording",
    "fricomp.calibration",
    "fricomp.control",
    "fricomp.sim_bench.diagnosis",
    "fricomp.sim_bench.stand_in",
)


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("fricomp", cache_dir=None)


@pytest.mark.parametrize("forbidden", _FORBIDDEN)
def test_no_chain_of_imports_leads_from_the_generator_to(forbidden: str, graph: grimp.ImportGraph) -> None:
    if forbidden not in graph.modules:
        pytest.skip(f"{forbidden} is not installed")
    chain = graph.find_shortest_chain("fricomp.sim_bench.concealed", forbidden, as_packages=True)
    assert chain is None


def test_the_diagnosis_does_not_import_the_generator(graph: grimp.ImportGraph) -> None:
    if "fricomp.sim_bench.diagnosis" not in graph.modules:
        pytest.skip("fricomp.sim_bench.diagnosis is not installed")
    downstream = graph.find_downstream_modules("fricomp.sim_bench.concealed", as_package=True)
    assert not [name for name in downstream if name.startswith("fricomp.sim_bench.diagnosis")]


def test_the_generator_imports_of_the_library_only_its_errors() -> None:
    folder = Path(concealed.__file__).parent
    imported = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 0 and (node.module or "").startswith("fricomp"):
                imported.add(node.module)
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names if alias.name.startswith("fricomp")}
    assert imported == {"fricomp.errors"}
