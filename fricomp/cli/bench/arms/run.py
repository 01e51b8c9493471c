"""`fricomp bench arms run`: conceal links and physics in arms, examine them blind, and score the answers."""

from pathlib import Path
from typing import Annotated

import typer

from ..options import ExecutorOption, WorkersOption, working

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench arms run --cases 10 --out runs/arms

fricomp bench arms run --scored --cases 200 --minutes 60 --resume --out runs/arms"""


@app.command(epilog=_EPILOG)
def run(
    out: Annotated[Path, typer.Option(help="Folder for seals, answers, records and scores.")] = Path("runs/arms"),
    cases: Annotated[int, typer.Option(min=1, help="Number of arms.")] = 200,
    duration: Annotated[float, typer.Option(help="Length of the recordings [s].")] = 60.0,
    scored: Annotated[bool, typer.Option("--scored", help="Seeds from a number drawn as the run begins.")] = False,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    minutes: Annotated[float | None, typer.Option(min=0.0, help="Start no arm after this; --resume goes on.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the run in OUT.")] = False,
    executor: ExecutorOption = "processes",
    workers: WorkersOption = None,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/arms-proof.md.")] = None,
) -> None:
    """Conceal links and physics in arms, examine them blind, and score the answers."""
    from fricomp.sim_bench.studies.arms import run_arms
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.proof import RunSettings, load_or_start
    from fricomp.sim_bench.studies.proof.settings import SETTINGS, stop_after

    from .show import show_scores, write_run_page

    with claim_run(out, SETTINGS), working("arms", cases, out, executor, workers) as (pool, count):
        settings = load_or_start(out, RunSettings(cases, scored=scored, first_seed=first_seed), resume=resume)
        scores = run_arms(
            settings,
            out,
            pool,
            duration=duration,
            progress=count,
            go_on=stop_after(minutes),
        )
    show_scores(scores)
    if page is not None:
        write_run_page(scores, settings, page)
