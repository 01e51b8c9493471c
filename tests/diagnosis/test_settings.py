"""Numbers that decide a diagnosis have a reason in words, where they are written."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

import fricomp.diagnosis

FOLDER = Path(fricomp.diagnosis.__file__).parent
STAGES = ("inputs", "joint", "effects", "search", "forward")
SEVERAL = ("evidence", "samples", "verdict", "report")
# Rows of the compiled simulator's state are places in an array; what data checks refuse is said where they do.
ELSEWHERE = {"kernel.py", "checks.py"}


def list_bare_numbers(body: list[ast.stmt]) -> Iterator[str]:
    """Names in a module or class that are given a number, and no sentence in the line below."""
    for statement, after in pairwise([*body, ast.Pass()]):
        value = statement.value if isinstance(statement, ast.Assign | ast.AnnAssign) else None
        numbers = [one for one in ast.walk(value) if isinstance(one, ast.Constant)] if value is not None else []
        if any(isinstance(one.value, int | float) and not isinstance(one.value, bool) for one in numbers):
            said = after.value if isinstance(after, ast.Expr) else None
            if not (isinstance(said, ast.Constant) and str(said.value).rstrip().endswith(".")):
                yield ast.unparse(statement)


PLAIN = {0, 1, 2, 3, 4, 0.5, 10, 100, 1000}
GUARD = 1e-6  # what is smaller keeps a quotient finite and decides nothing
DOCUMENTED = {"form", "least_form", "prior", "known"}  # of `EffectParameter`, which says where they come from


def list_numbers_in_functions(source: str) -> Iterator[str]:
    """Statements of functions with a number that decides something and no comment in them or above.

    Places in arrays, powers, and numbers that only count or halve decide nothing.
    """
    tree = ast.parse(source)
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    comments = {token.start[0] for token in tokens if token.type == tokenize.COMMENT}
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for statement in {id(s): s for f in functions for s in ast.walk(f) if isinstance(s, ast.stmt)}.values():
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            continue
        inner = [part for part in ast.iter_child_nodes(statement) if isinstance(part, ast.expr)]
        numbers = [value for part in inner for value in _list_deciding(part)]
        lines = range(statement.lineno - 1, max((part.end_lineno or 0 for part in inner), default=0) + 1)
        if numbers and not comments & set(lines):
            yield f"{statement.lineno}: {numbers} in {ast.unparse(statement).splitlines()[0]}"


def _list_deciding(node: ast.AST) -> Iterator[float]:
    if isinstance(node, ast.Constant):
        value = node.value
        if isinstance(value, int | float) and value not in PLAIN and abs(value) > GUARD:
            yield value
    elif isinstance(node, ast.Subscript):
        yield from _list_deciding(node.value)
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        yield from _list_deciding(node.left)
    elif not (isinstance(node, ast.keyword) and node.arg in DOCUMENTED):
        for child in ast.iter_child_nodes(node):
            yield from _list_deciding(child)


@pytest.mark.parametrize("stage", ["effects", "verdict", "record"])
def test_every_number_in_a_function_of_a_stage_is_explained(stage: str) -> None:
    paths = sorted((FOLDER / stage).rglob("*.py"))
    assert paths
    bare = [f"{path.name}:{said}" for path in paths for said in list_numbers_in_functions(path.read_text())]
    assert not bare


def test_a_number_in_a_function_is_seen_unless_it_decides_nothing_or_is_explained() -> None:
    body = "def f(x):\n    {}"
    bare = [
        "return x > 0.35",
        "if x < 7: pass",
        "y = max(x, 2e-3)",
        "return g(x, low=-0.7)",
        "return [a for a in (5, 6)]",
    ]
    fine = ["return x > 0.35  # a third", "# a third\n    return x > 0.35", "return 0.5 * x[7] ** 3 / max(x, 1e-9)"]
    assert all(list(list_numbers_in_functions(body.format(line))) for line in bare)
    assert not any(list(list_numbers_in_functions(body.format(line))) for line in fine)


@pytest.mark.parametrize("stage", [*STAGES, *SEVERAL[:-1], "record"])
def test_every_number_of_a_stage_is_explained(stage: str) -> None:
    bare = [
        f"{path.relative_to(FOLDER)}: {name}"
        for path in sorted((FOLDER / stage).rglob("*.py"))
        if path.name not in ELSEWHERE
        for name in list_bare_numbers(ast.parse(path.read_text()).body)
    ]
    assert not bare


@pytest.mark.parametrize("stage", STAGES)
def test_every_setting_of_a_stage_is_explained(stage: str) -> None:
    module = ast.parse((FOLDER / stage / "settings.py").read_text())
    (settings,) = (one for one in module.body if isinstance(one, ast.ClassDef))
    assert ast.unparse(settings.decorator_list[0]) == "dataclass(frozen=True)"
    assert not list(list_bare_numbers(settings.body))


@pytest.mark.parametrize("stage", SEVERAL)
def test_every_setting_of_a_stage_of_several_classes_is_explained(stage: str) -> None:
    module = ast.parse((FOLDER / stage / "settings.py").read_text())
    for settings in (one for one in module.body if isinstance(one, ast.ClassDef)):
        assert ast.unparse(settings.decorator_list[0]) == "dataclass(frozen=True)"
        said = ast.get_docstring(settings) or ""
        fields = [ast.unparse(one.target) for one in settings.body if isinstance(one, ast.AnnAssign)]
        assert fields
        assert [name for name in fields if f"\n    {name}: " not in said] == []
