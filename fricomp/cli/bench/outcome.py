"""What the commands share whose study gives an outcome: the folder is free, and it is written, printed and judged."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.kit.outcome import StudyOutcome

__all__ = ["begin_study", "end_study"]


def begin_study(out: Path, *packages: str, overwrite: bool) -> None:
    """Refuse before anything is measured what could not be written after it.

    Args:
        out: Folder of the results.
        packages: What the study needs besides the packages of reports.
        overwrite: Whether earlier results may be replaced.
    """
    from fricomp.extras import REPORT, require
    from fricomp.results import FIGURES, require_free

    require_free(out, FIGURES, overwrite=overwrite)
    require(*REPORT, *packages)


def end_study(outcome: StudyOutcome, out: Path, *, numbered: bool = False) -> None:
    """Write an outcome, print its tables and sentences, and exit with 1 where a target was missed."""
    from rich.table import Table as Printed

    from fricomp.cli.terminal import console
    from fricomp.report import Table
    from fricomp.sim_bench.studies.kit.outcome import write_outcome

    write_outcome(outcome, out, numbered=numbered)
    screen = console()
    for section in outcome.sections:
        for block in section.blocks:
            if isinstance(block, str):
                screen.print(block)
            elif isinstance(block, Table):
                printed = Printed(*block.columns, title=section.title)
                for row in block.rows:
                    printed.add_row(*row)
                screen.print(printed)
    screen.print(f"Figures and report in {out}")
    if not outcome.passed:
        raise typer.Exit(1)
