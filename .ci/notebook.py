"""Runs a notebook from its first cell to its last, and keeps what its cells show: texts, tables and pictures.

    python .ci/notebook.py docs/from_data_to_compensator.ipynb

The file is written anew with these outputs. No kernel is needed: cells are executed in one namespace, and
the last expression of each is shown by the methods that notebooks ask for. The working folder is a temporary one.
"""

from __future__ import annotations

import argparse
import ast
import base64
import io
import json
import os
import tempfile
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

__all__ = ["execute_notebook"]


def execute_notebook(notebook: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The notebook with the outputs of its cells.

    Args:
        notebook: As its file holds it.
        folder: In which it runs.
    """
    known: dict[str, Any] = {"__name__": "__main__"}
    cells, number = [], 0
    with chdir(folder):
        for cell in notebook["cells"]:
            if cell["cell_type"] == "code":
                number += 1
                outputs = _run_cell("".join(cell["source"]), f"cell {number}", known, number)
                cells.append({**cell, "execution_count": number, "outputs": outputs})
            else:
                cells.append(cell)
    return {**notebook, "cells": cells}


def _run_cell(code: str, name: str, known: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """What a cell prints, and what its last expression shows."""
    tree, told, value = ast.parse(code, name), io.StringIO(), None
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    with redirect_stdout(told):
        exec(compile(tree, name, "exec"), known)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), name, "eval"), known)
    outputs: list[dict[str, Any]] = []
    if told.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": told.getvalue().splitlines(keepends=True)})
    if value is not None:
        shown = {"output_type": "execute_result", "execution_count": number, "metadata": {}, "data": _show(value)}
        outputs.append(shown)
    return outputs


def _show(value: Any) -> dict[str, Any]:
    """A value by the kinds of output that it has."""
    data: dict[str, Any] = {"text/plain": repr(value).splitlines(keepends=True)}
    as_html = getattr(value, "_repr_html_", None)
    html = as_html() if as_html is not None else None
    if html is not None:
        data["text/html"] = html.splitlines(keepends=True)
    if hasattr(value, "savefig"):
        stream = io.BytesIO()
        value.savefig(stream, format="png", dpi=72, metadata={"Software": None})
        data["image/png"] = base64.b64encode(stream.getvalue()).decode()
    return data


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("notebook", type=Path)
    path = parser.parse_args().notebook.absolute()
    os.environ.setdefault("MPLBACKEND", "agg")
    with tempfile.TemporaryDirectory() as folder:
        done = execute_notebook(json.loads(path.read_text("utf-8")), Path(folder))
    path.write_text(json.dumps(done, indent=1, ensure_ascii=False) + "\n", "utf-8")


if __name__ == "__main__":
    _main()
