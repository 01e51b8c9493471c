"""`fricomp bench mismatch replay`: the cases of a kept run made again, and diagnosed by the diagnosis of today."""

from pathlib import Path
from typing import Annotated

import typer

from ..options import ExecutorOption, WorkersOption

app = typer.Typer(add_completion=False)

_EPILOG = "fricomp bench mismatch replay docs/proof --cases 20 --out runs/replay"
_OUT = Path("runs/replay")


@app.command(epilog=_EPILOG)
def replay(
    kept: Annotated[Path, typer.Argument(help="Folder with the run.json of the run, such as docs/proof.")],
    out: Annotated[Path, typer.Option(help="Folder for answers, diagnoses and scores; one there goes on.")] = _OUT,
    cases: Annotated[int | None, typer.Option(min=1, help="Number of cases; all of the run by default.")] = None,
    minutes: Annotated[float | None, typer.Option(min=0.0, help="Start no case after this.")] = None,
    executor: ExecutorOption = "processes",
    workers: WorkersOption = None,
    page: Annotated[Path | None, typer.Option(help="Write a page of the replay.")] = None,
) -> None:
    """Make the cases of a kept run again, diagnose them blind, and score the answers.

    The cases follow from the key in run.json; the diagnosis is that of today.
    """
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.proof import load_replay
    from fricomp.sim_bench.studies.proof.run import ANSWERS

    from . import work, write

    if page is not None and page.with_suffix("").resolve() == kept.resolve():
        raise DiagnosisError(f"{page} is of the run itself: give the replay a --page of its own, or none")
    require_own_page(page, "proof")
    with claim_run(out, ANSWERS):
        settings = load_replay(kept, out, cases)
        scores, planned = work.work_through(settings, out, (executor, workers), minutes)
        work.show_scores(scores, planned, out)
        if page is not None:
            write.write_run_page(page, settings, scores, len(planned), out, "")
