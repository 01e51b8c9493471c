"""What `diagnose` and `identify` share when they are given a fleet of joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from fricomp.fleet import FleetJoint, FleetRow, Work
    from fricomp.report import Table

__all__ = ["Executor", "FleetRun", "Resume", "Workers", "rich_table", "run_joints", "show_fleet"]

Executor = Annotated[
    str, typer.Option(rich_help_panel="Of a fleet", help="Of a fleet: processes, serial or dask://host:port.")
]
Workers = Annotated[
    int | None, typer.Option(min=1, rich_help_panel="Of a fleet", help="Of a fleet; one a core by default.")
]
Resume = Annotated[
    bool, typer.Option("--resume", rich_help_panel="Of a fleet", help="Of a fleet: go on with the one in --out.")
]


@dataclass(frozen=True)
class FleetRun:
    """Where a fleet runs, and whether it goes on with what is there."""

    executor: str
    workers: int | None
    resume: bool

    @property
    def given(self) -> dict[str, bool]:
        """Each option, and whether it is another than the default: of one file it would be ignored."""
        return {
            "--executor": self.executor != "processes",
            "--workers": self.workers is not None,
            "--resume": self.resume,
        }


def run_joints(
    joints: Sequence[FleetJoint],
    work: Work,
    out: Path,
    run: FleetRun,
    settings: Mapping[str, Any],
    title: str,
    *,
    check: Callable[[FleetJoint, Path], None] = lambda joint, folder: None,
) -> list[FleetRow]:
    """Do all joints under one progress bar; rows in the order of the joints."""
    from fricomp.cli.terminal import progress, resumable
    from fricomp.fleet import open_executor, run_fleet

    with resumable(out), progress() as bar, open_executor(run.executor, run.workers) as pool:
        task = bar.add_task(title, total=len(joints))

        def say(row: FleetRow | None) -> None:
            bar.update(task, advance=1, description=f"{title}: {row['name']}" if row else title)

        return run_fleet(joints, work, out, pool, settings=settings, resume=run.resume, progress=say, check=check)


def show_fleet(rows: Sequence[FleetRow], table: Table, page: Path) -> None:
    """Print what the joints are warned of, their table, and where the page on all of them is."""
    from fricomp.cli.terminal import console

    show = console()
    for row in rows:
        for warning in (row.get("warnings") or "").splitlines():
            show.print(f"{row['name']}: {warning}", style="yellow", markup=False)
    show.print(rich_table(table))
    table_file = page.with_name("fleet.parquet")
    show.print(f"\nThe whole fleet: {page}; as a table: {table_file}", soft_wrap=True, markup=False)


def rich_table(table: Table) -> Any:
    """A table of a report for the terminal."""
    from rich.table import Table as RichTable

    shown = RichTable(title=table.caption or None, title_justify="left", box=None, pad_edge=False)
    for column in table.columns:
        shown.add_column(column, overflow="fold")
    for row in table.rows:
        shown.add_row(*row)
    return shown
