"""`fricomp bench second-generator`: the diagnosis on joints that MuJoCo makes."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

from .options import ExecutorOption, working

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench second-generator --page docs/second_generator.md --out runs/second

fricomp bench second-generator --only backlash --out runs/second"""


@app.command(epilog=_EPILOG)
def second_generator(
    out: Annotated[Path, typer.Option(help="Folder for recordings and diagnoses, one of each case.")],
    only: Annotated[list[str] | None, typer.Option(help="Name of a case or an effect; all without it.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="20 s of each recording in place of 60.")] = False,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/second_generator.md.")] = None,
    executor: ExecutorOption = "processes",
    resume: Annotated[bool, typer.Option("--resume", help="Keep the cases that are in OUT already.")] = False,
    overwrite: Overwrite = False,
) -> None:
    """Diagnose joints whose left-out physics is MuJoCo's own, and compare with what is known about them."""
    from fricomp.cli.terminal import Table, console, make_table
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.second_generator import choose_cases, compute_figures, run_all, write_page

    if only and page is not None:
        raise DiagnosisError("a page is of all cases: leave out --only, or --page")
    cases = choose_cases(only or (), quick=quick)
    require_own_page(page, "second_generator")
    claim = claim_run(out, "scores.jsonl", go_on=resume or overwrite)
    with claim, working("cases", len(cases), out, executor) as (pool, count):
        scores, commits = run_all(cases, out, pool, resume=resume, progress=count)
    table = Table("case", "verdict", "named", "right", "seconds")
    for one in scores:
        right = "no" if one.wrong else "yes"
        table.add_row(one.case.name, one.verdict, ", ".join(one.named) or one.error or "–", right, f"{one.seconds:.0f}")
    console().print(table)
    console().print(make_table(["figure", "measured (95 % interval)"], compute_figures(scores)))
    if page is not None:
        write_page(scores, page, commits, quick=quick)
        console().print(f"{page} written", soft_wrap=True)
