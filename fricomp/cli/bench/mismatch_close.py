"""`fricomp bench mismatch-close`: a scored run ends with a reason before all of its cases were diagnosed."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import LOG, LogOption

app = typer.Typer(add_completion=False)


@app.command(epilog='fricomp bench mismatch-close "the diagnosis was changed"')
def mismatch_close(
    reason: Annotated[str, typer.Argument(help="Why it ends; kept in the log.")],
    log: LogOption = LOG,
) -> None:
    """End the scored run that is kept beside the log, and put its data into a folder of its own."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.proof import close_run

    run = close_run(reason, log)
    console().print(f"scored run {run} is closed; its data is in {log.parent / f'run-{run}'}", soft_wrap=True)
