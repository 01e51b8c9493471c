"""The notebook runs as it stands, from a log to a compensator, and shows what it was stored with."""

from __future__ import annotations

import base64
import json
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]


def _load() -> ModuleType:
    spec = spec_from_file_location("notebook", ROOT / ".ci" / "notebook.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


NOTEBOOK = _load()


def _outputs(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    return [one for cell in notebook["cells"] for one in cell.get("outputs", ())]


def _kinds(notebook: dict[str, Any]) -> list[list[str]]:
    return [sorted(one.get("data", {one.get("name", ""): ""})) for one in _outputs(notebook)]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, Any]]:
    """The notebook as it is stored, and as it comes out of a run."""
    stored = json.loads((ROOT / "docs" / "from_data_to_compensator.ipynb").read_text("utf-8"))
    return stored, NOTEBOOK.execute_notebook(stored, tmp_path_factory.mktemp("notebook"))


def test_it_shows_tables_and_pictures_inline_as_it_was_stored(
    runs: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    stored, done = runs
    assert _kinds(done) == _kinds(stored)
    pictures = [one["data"]["image/png"] for one in _outputs(done) if "image/png" in one.get("data", {})]
    assert len(pictures) == 2
    assert all(base64.b64decode(one).startswith(b"\x89PNG") for one in pictures)
    assert any("<table>" in "".join(one.get("data", {}).get("text/html", "")) for one in _outputs(done))


def test_what_it_finds_compensates_most_of_the_friction(runs: tuple[dict[str, Any], dict[str, Any]]) -> None:
    texts = ["".join(one.get("text", "")) for notebook in runs for one in _outputs(notebook)]
    shares = [float(text.split("%")[0]) for text in texts if "% of the friction torque is left" in text]
    assert len(shares) == 2  # stored, and found now
    assert all(0.0 < share < 5.0 for share in shares)


def test_a_cell_that_fails_fails_the_run(tmp_path: Path) -> None:
    cell = {"cell_type": "code", "source": ["1 / 0"], "metadata": {}}
    with pytest.raises(ZeroDivisionError):
        NOTEBOOK.execute_notebook({"cells": [cell]}, tmp_path)


def test_the_last_expression_is_shown_and_an_assignment_is_not(tmp_path: Path) -> None:
    cells = [{"cell_type": "code", "source": source} for source in (["a = 3\n", "print(a)"], ["a + 1"], ["b = a"])]
    done = NOTEBOOK.execute_notebook({"cells": cells}, tmp_path)
    shown = [[one.get("text") or one["data"]["text/plain"] for one in cell["outputs"]] for cell in done["cells"]]
    assert shown == [[["3\n"]], [["4"]], []]
