"""Functions of control, reports, the generator of cases and the paper's study begin with a verb too."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from fricomp import control, report
from fricomp.sim_bench import cases
from fricomp.sim_bench.studies import paper

from ..diagnosis.test_names import LEAST, begins_with_a_verb, list_functions

WORDS = """
adapt admit append arm assign bind change conceal configure contaminate disarm distort drop enable forget freeze
generate handle indent interrupt limit open order outline parse publish record render repeat require reset rotate
sense settle stick stop style summarise swell thin trip turn update view warm warn watch wrap
"""
MORE = frozenset(WORDS.split())
"""Verbs that the diagnosis does without."""


@pytest.mark.parametrize("package", [cases, control, paper, report], ids=lambda package: package.__name__)
def test_functions_begin_with_a_verb(package: object) -> None:
    folder = Path(str(package.__file__)).parent  # type: ignore[attr-defined]
    names = [name for path in sorted(folder.rglob("*.py")) for name in list_functions(ast.parse(path.read_text()))]
    others = [n for n in names if not begins_with_a_verb(n) and n.strip("_").split("_")[0] not in MORE]
    assert len(others) <= (1.0 - LEAST) * len(names), f"{len(others)} of {len(names)} do not: {sorted(set(others))}"
