"""Numbers that decide a diagnosis have a reason in words, where they are written."""

from __future__ import annotations

import ast
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
