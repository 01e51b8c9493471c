"""What `diagnose` and `identify` share when they are given a fleet of joints."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from fricomp.cli.option.panel import fleet_option
from fricomp.cli.output import answer

if TYPE_CHECKING:
    from fricomp.fleet import FleetJoint, FleetRow, Work
    from fricomp.report import Table

__all__ = [
    "Executor",
    "FailIf",
    "FleetRun",
    "Resume",
    "Workers",
    "rich_table",
    "run_joints",
    "say_same_joint",
    "show_fleet",
]

Executor = Annotated[str, fleet_option(help="Where a fleet runs: processes, serial or dask://host:port.")]
Workers = Annotated[int | None, fleet_option(min=1, help="Number of processes for a fleet; one a core by default.")]
Resume = Annotated[bool, fleet_option("--resume", help="Continue the fleet in --out.")]
FailIf = Annotated[
    Literal["any", "missing", "unusable"] | None,
    fleet_option(
        help="End with exit status 1 if the answer of a joint is at least this bad; any: anything found to be off."
    ),
]
EXIT_FOUND = 1
"""Exit status of --fail-if where a joint's answer is as bad as that."""


@dataclass(frozen=True)
class FleetRun:
    """Where a fleet runs, and whether it goes on with what is there."""

    executor: str
    workers: int | None
    resume: bool
    fail_if: str | None = None

    @property
    def given(self) -> dict[str, bool]:
        """Each option, and whether it is another than the default: of one file it would be ignored."""
        return {
            "--executor": self.executor != "processes",
            "--workers": self.workers is not None,
            "--resume": self.resume,
            "--fail-if": self.fail_if is not None,
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


def show_fleet(
    rows: Sequence[FleetRow], build: Callable[[Sequence[FleetRow]], Table], page: Path, run: FleetRun
) -> None:
    """Print what the joints are warned of, their table, and where the page on all of them is.

    The worst answers come first; those of one kind stand in the order of the joints.

    Raises:
        typer.Exit: An answer is as bad as `--fail-if` says.
    """
    from fricomp.cli.terminal import console
    from fricomp.fleet import Severity, rate_row

    rows, table = sorted(rows, key=rate_row, reverse=True), page.with_name("fleet.parquet")
    show = console()
    for row in rows:
        for warning in (row.get("warnings") or "").splitlines():
            show.print(f"{row['name']}: {warning}", style="yellow", markup=False)
    answer({"joints": rows, "page": page, "table": table})
    show.print(rich_table(build(rows)))
    show.print(f"\nThe whole fleet: {page}; as a table: {table}", soft_wrap=True, markup=False)
    least = {"any": Severity.PARAMETERS, "missing": Severity.MISSING, "unusable": Severity.UNUSABLE}
    if run.fail_if is not None and any(rate_row(row) >= least[run.fail_if] for row in rows):
        raise typer.Exit(EXIT_FOUND)


def say_same_joint(rows: Sequence[FleetRow], files: Sequence[str], out: Path) -> None:
    """Print that files which name one joint, or none, were taken one by one, and how they are fitted together.

    Args:
        rows: Of the fleet.
        files: What was given to the command.
        out: Folder of the fleet.
    """
    from fricomp.cli.terminal import console
    from fricomp.fleet import is_joint_table
    from fricomp.model import load_model

    models = [out / str(row["name"]) / "friction.json" for row in rows if not row["error"]]
    models = [path for path in models if path.exists()]
    if len(models) < 2 or any(map(is_joint_table, files)):
        return
    joint = load_model(models[0]).joint
    if any(load_model(path).joint != joint for path in models[1:]):  # the first other one ends it
        return
    given = " ".join(map(shlex.quote, files))
    console().print(
        f"{len(rows)} files of joint {joint!r}, as they say or since they name none: each was taken as a joint of a "
        f"fleet. If they are runs of one joint: 'fricomp diagnose {given} --out {out}_together' fits them together.",
        style="yellow",
        markup=False,
    )


def rich_table(table: Table) -> Any:
    """A table of a report for the terminal."""
    from fricomp.cli.terminal import make_table

    return make_table(table.columns, table.rows, title=table.caption or None, box=None, pad_edge=False)
