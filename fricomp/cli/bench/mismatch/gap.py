"""`fricomp bench mismatch gap`: how much of the held-out error a diagnosis closes, of what could be closed."""

from pathlib import Path
from typing import Annotated

import typer

from ..options import ExecutorOption, WorkersOption, working

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench mismatch gap --cases 24 --first-seed 810000 --page docs/proof.md --out runs/gap

fricomp bench mismatch gap --quick --cases 4 --out runs/gap"""
_OUT = Path("runs/gap")


@app.command(epilog=_EPILOG)
def gap(
    out: Annotated[Path, typer.Option(help="Folder for the cases and the table; the same command goes on.")] = _OUT,
    cases: Annotated[int, typer.Option(min=1, help="Number of cases.")] = 24,
    quick: Annotated[bool, typer.Option("--quick", help="Cases of 30 s.")] = False,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    executor: ExecutorOption = "processes",
    workers: WorkersOption = None,
    page: Annotated[
        Path | None, typer.Option(help="Page of `bench mismatch` that shows the table from now on.")
    ] = None,
) -> None:
    """Diagnose concealed cases twice, as they are and without what is concealed, and compare the held-out errors."""
    from datetime import date

    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.kit.commit import find_commit, format_measured
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import replace_page, require_own_page
    from fricomp.sim_bench.studies.proof import (
        GAP,
        QUICK_DURATION,
        format_gaps,
        list_development_seeds,
        measure_gaps,
        plan_gaps,
    )

    planned = plan_gaps(cases, list_development_seeds(first_seed), QUICK_DURATION if quick else None)
    if page is not None:
        require_own_page(page.with_suffix("") / GAP, "proof")
    way = "the same command goes on"
    with claim_run(out, "gap"), working("diagnosed twice", cases, out, executor, workers, way=way) as (pool, count):
        scores = measure_gaps(planned, out / "gap", pool, progress=count)
    options = f"--cases {cases} {'--quick ' if quick else ''}--first-seed {first_seed} --out runs/{out.name}"
    measured = format_measured(date.today(), find_commit())
    text = format_gaps(scores, f"fricomp bench mismatch gap {options}", measured)
    for path in (out / GAP, *((page.with_suffix("") / GAP,) if page is not None else ())):
        replace_page(path, text, "proof")
    console().print(text, soft_wrap=True)
