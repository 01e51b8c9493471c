"""`fricomp bench mismatch compare`: the answers of two runs of the same cases side by side."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(add_completion=False)

_EPILOG = "fricomp bench mismatch compare runs/before runs/after"


@app.command(epilog=_EPILOG)
def compare(
    first: Annotated[Path, typer.Argument(help="Folder of a run, such as one of an earlier version.")],
    second: Annotated[Path, typer.Argument(help="Folder of another run of the same cases.")],
    fail_if_changed: Annotated[
        bool, typer.Option("--fail-if-changed", help="Exit status 1 where a verdict or a name differs.")
    ] = False,
) -> None:
    """Show where verdict or names differ, the largest move of a parameter, and both times."""
    from fricomp.cli.terminal import Table, console
    from fricomp.sim_bench.studies.proof.side_by_side import compare_runs

    pairs = compare_runs(first, second)
    changed = [one for one in pairs if one.differs]
    table = Table("case", "concealed", "first", "second", "largest move [deviations]")
    for one in changed:
        table.add_row(one.case, one.truth or "–", " ".join(one.before), " ".join(one.after), f"{one.shift:.2f}")
    screen = console()
    if changed:
        screen.print(table)
    moved = max((one.shift for one in pairs if not one.differs), default=0.0)
    before, after = (sum(one.seconds[i] for one in pairs) for i in (0, 1))
    screen.print(
        f"{len(pairs)} cases, {len(changed)} with another verdict or name; elsewhere parameters move by at most "
        f"{moved:.2g} standard deviations. Seconds: {before:.0f} and {after:.0f}.",
        soft_wrap=True,
    )
    if changed and fail_if_changed:
        raise typer.Exit(1)
