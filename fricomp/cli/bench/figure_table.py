"""The figures of a study as a table on the terminal; those that miss their target stand out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fricomp.cli.terminal import Table

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.kit.figure import Figure


def make_figure_table(figures: Sequence[Figure[Any]]) -> Table:
    """A row for each figure."""
    table = Table("figure", "target", "measured (95 % interval)", "reached")
    for figure in figures:
        style = "" if figure.reached is not False else "bold"
        table.add_row(figure.name, figure.target, figure.value, figure.standing, style=style)
    return table
