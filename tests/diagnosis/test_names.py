"""Functions of the diagnosis begin with a verb: the first word is one of those here, or says a predicate."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import fricomp.diagnosis

WORDS = """
add advance aim align apply ask average begin bin bound broadcast build centre check choose clip close collect combine
compare compile compute confirm convert correct correlate count creep curb cut delay derive descend describe diagnose
differ differentiate divide draw dwell estimate evaluate even expand explain extend feel find finish fit follow format
free get group grow hold identify improve inline join judge keep key label lag learn leave level list load locate look
lower make map match measure merge minimise move multiply name narrow observe orthonormalise pack place polish predict
prefer prepare project propose pull pursue push put raise rank read rebuild recall recolour reduce refine refit refuse
register remember remove renew replace report reweigh run sample save scale scan screen search select set shape share
shift shorten simulate smooth solve split stack start step straighten subtract sum swap take trace train try undo
unpack weigh whiten write
"""
VERBS = frozenset(WORDS.split())
PREFIXES = frozenset({"is", "has", "can", "needs", "does", "to", "from"})
LEAST = 0.85


def list_functions(tree: ast.AST) -> Iterator[str]:
    """Names of functions and methods; neither properties nor those that the language names."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            decorators = {ast.unparse(one) for one in node.decorator_list}
            special = node.name.startswith("__") or decorators & {"property", "cached_property"}
            if not special and not any(one.endswith((".setter", "fixture")) for one in decorators):
                yield node.name


def begins_with_a_verb(name: str) -> bool:
    """Whether the first word of a name is a verb or says a predicate or a conversion."""
    return name.strip("_").split("_")[0] in VERBS | PREFIXES


def test_functions_begin_with_a_verb() -> None:
    folder = Path(fricomp.diagnosis.__file__).parent
    names = [name for path in sorted(folder.rglob("*.py")) for name in list_functions(ast.parse(path.read_text()))]
    others = [name for name in names if not begins_with_a_verb(name)]
    assert len(others) <= (1.0 - LEAST) * len(names), f"{len(others)} of {len(names)} do not: {sorted(set(others))}"


def test_a_participle_is_no_verb() -> None:
    assert not any(map(begins_with_a_verb, ("told", "_agreed", "beside", "residuals", "_fitted")))
    assert all(map(begins_with_a_verb, ("fit_base", "_is_loud", "to_slots", "compute_curve")))


def test_the_documentation_names_modules_that_exist() -> None:
    folder = Path(fricomp.diagnosis.__file__).parent
    modules = {path.stem for path in folder.rglob("*.py")}
    page = (Path(__file__).parents[2] / "docs/diagnosis_method.md").read_text()
    table = page.split("| step | module | what it does |")[1].split("\n\n")[0]
    named = [name for row in table.splitlines()[2:] for name in re.findall(r"`(\w+)`", row.split("|")[2])]
    assert len(named) > 20
    assert set(named) <= modules
