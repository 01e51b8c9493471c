"""Functions of the generator of cases and of the paper's study begin with a verb, as those of the diagnosis do."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from fricomp.sim_bench import cases
from fricomp.sim_bench.studies import paper

from ..diagnosis.test_names import LEAST, begins_with_a_verb, list_functions

WORDS = """
change conceal contaminate distort drop freeze generate parse publish record repeat rotate sense settle stick summarise
swell turn warm wrap
"""
MORE = frozenset(WORDS.split())
"""Verbs that only the bench needs."""


@pytest.mark.parametrize("package", [cases, paper], ids=lambda package: package.__name__)
def test_functions_begin_with_a_verb(package: object) -> None:
    folder = Path(str(package.__file__)).parent  # type: ignore[attr-defined]
    names = [name for path in sorted(folder.rglob("*.py")) for name in list_functions(ast.parse(path.read_text()))]
    others = [n for n in names if not begins_with_a_verb(n) and n.strip("_").split("_")[0] not in MORE]
    assert len(others) <= (1.0 - LEAST) * len(names), f"{len(others)} of {len(names)} do not: {sorted(set(others))}"
