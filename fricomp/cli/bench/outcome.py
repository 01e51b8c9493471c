"""What the commands share whose study gives an outcome: the folder is free, and it is written, printed and judged."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.kit.outcome import StudyOutcome


@contextmanager
def claim_study(out: Path, *packages: str, overwrite: bool) -> Iterator[None]:
    """Refuse before anything is measured what could not be written after it, and keep the folder to this process.

    Args:
        out: Folder of the results.
        packages: What the study needs besides the packages of reports.
        overwrite: Whether earlier results may be replaced.
    """
    from fricomp.extras import REPORT, require
    from fricomp.result_kinds import FIGURES
    from fricomp.results import claim_folder

    with claim_folder(out, FIGURES, overwrite=overwrite):
        require(*REPORT, *packages)
        yield


def end_study(outcome: StudyOutcome, out: Path) -> None:
    """Print the tables and sentences of an outcome that was written, and exit with 1 where a target was missed."""
    from fricomp.cli.terminal import console, make_table
    from fricomp.report import Table

    screen = console()
    for section in outcome.sections:
        for block in section.blocks:
            if isinstance(block, str):
                screen.print(block)
            elif isinstance(block, Table):
                screen.print(make_table(block.columns, block.rows, title=section.title))
    screen.print(f"Figures and report in {out}")
    if not outcome.passed:
        raise typer.Exit(1)
