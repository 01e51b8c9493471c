"""What commands print stands as it was written."""

from typing import Any

import pytest

from fricomp.cli.fleet import rich_table
from fricomp.cli.terminal import console
from fricomp.report import Table


def test_brackets_are_printed_and_not_taken_for_markup(capsys: Any) -> None:
    console().print("pip install '.[serial]' into [bold]", soft_wrap=True)
    assert capsys.readouterr().out == "pip install '.[serial]' into [bold]\n"


@pytest.mark.parametrize("cell", ["runs/[red]", "a [x] b", "\\[y]"])
def test_cells_of_a_table_keep_their_brackets(capsys: Any, cell: str) -> None:
    console().print(rich_table(Table(("joint [1]",), ((cell,),), "")))
    out = capsys.readouterr().out
    assert cell in out
    assert "joint [1]" in out
