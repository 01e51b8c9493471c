"""`fricomp bench mismatch-replay`: a scored run made again from what is kept of it, or only its sealed answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import LOG, ExecutorOption, LogOption, WorkersOption

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench mismatch-replay 27 --cases 20 --out runs/replay

fricomp bench mismatch-replay 27 --verify"""
_OUT = Path("runs/replay")


@app.command(epilog=_EPILOG)
def mismatch_replay(
    run: Annotated[int, typer.Argument(min=1, help="Number of the scored run.")],
    out: Annotated[
        Path, typer.Option(help="Folder for answers, diagnoses and scores; one that is there goes on.")
    ] = _OUT,
    cases: Annotated[int | None, typer.Option(min=1, help="How many; all of the run by default.")] = None,
    verify: Annotated[bool, typer.Option("--verify", help="Only make the answers, and check their seals.")] = False,
    minutes: Annotated[float | None, typer.Option(min=0.0, help="Start no case after this.")] = None,
    executor: ExecutorOption = "processes",
    workers: WorkersOption = None,
    log: LogOption = LOG,
    page: Annotated[Path | None, typer.Option(help="Write a page of the replay.")] = None,
) -> None:
    """Diagnose the cases of a scored run anew, by the diagnosis and generator it had; no log knows of it."""
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.proof import load_replay

    from . import mismatch_page, mismatch_run

    if page is not None and page.with_suffix("").resolve() == log.parent.resolve():
        raise DiagnosisError(f"{page} is of the run itself: give the replay a --page of its own, or none")
    if verify:
        _verify(run, log, (executor, workers))
        return
    settings = load_replay(run, out, log, Path.cwd(), cases)
    scores, planned = mismatch_run.run(settings, out, (executor, workers), minutes, log)
    mismatch_run.show(scores, planned, out)
    if page is not None:
        mismatch_page.write(page, settings, scores, len(planned), out, "", log)


def _verify(run: int, log: Path, executor: tuple[str, int | None]) -> None:
    """Make the answers of a scored run again and compare."""
    from fricomp.cli.terminal import console, progress
    from fricomp.errors import DiagnosisError
    from fricomp.fleet import open_executor
    from fricomp.sim_bench.studies.proof import verify_seals

    with progress() as bar, open_executor(*executor) as pool:
        task = bar.add_task("answers made again", total=None)
        found = verify_seals(run, log, pool, Path.cwd(), lambda total: bar.update(task, total=total, advance=1))
    told = f"scored run {run}: {found.agree} answers made again have the hash that was sealed"
    told += f", {found.near} another that tells the same, of another processor" if found.near else ""
    told += f", {found.unmade} cases could not be made then or now" if found.unmade else ""
    console().print(told, soft_wrap=True)
    if not found.holds:
        parts = {
            "tell something else than was sealed": found.differ,
            "are not in the plan of this code": found.unplanned,
            "could not be made then and can now": found.unexpected,
        }
        raise DiagnosisError("; ".join(f"{len(some)} {what}, {some[0]} first" for what, some in parts.items() if some))
