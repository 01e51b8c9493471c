"""`fricomp bench real`: the diagnosis on public recordings of real joints."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

from .options import ExecutorOption, working

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench real --page docs/real.md --out runs/real

fricomp bench real --only ur10e-joint-2 --out runs/real"""


@app.command(epilog=_EPILOG)
def real(
    out: Annotated[Path, typer.Option(help="Folder for the diagnoses, one each.")],
    only: Annotated[list[str] | None, typer.Option(help="Name of a case; all without it.")] = None,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/real.md.")] = None,
    executor: ExecutorOption = "processes",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the diagnoses.")] = 0,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the cases that are in OUT already.")] = False,
    overwrite: Overwrite = False,
) -> None:
    """Diagnose recordings that nobody here made, and compare with what is known about them."""
    from datetime import date

    from fricomp.cli.terminal import Table, console
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.kit.commit import format_measured
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.real import REAL_CASES, run_all, write_real_page

    if only and page is not None:
        raise DiagnosisError("a page is of all recordings: leave out --only, or --page")
    known = {case.name: case for case in REAL_CASES}
    unknown = sorted(set(only or ()) - set(known))
    if unknown:
        raise DiagnosisError(f"no case {unknown[0]!r}: valid are {', '.join(known)}")
    cases = [known[name] for name in only] if only else list(REAL_CASES)
    require_own_page(page, "real")
    claim = claim_run(out, "outcomes.jsonl", go_on=resume or overwrite)
    with claim, working("recordings", len(cases), out, executor) as (pool, count):
        outcomes, commits = run_all(cases, out, pool, seed=seed, resume=resume, progress=count)
    table = Table("recording", "verdict", "named", "as expected", "time [s]")
    for one in outcomes:
        verdict = one.record.verdict if one.record is not None else "no answer"
        named = ", ".join(effect.name for effect in one.record.effects) if one.record is not None else one.error
        mark = {True: "yes", False: "no", None: "–"}[one.reached]
        table.add_row(one.case.name, verdict, named or "–", mark, f"{one.seconds:.0f}")
    console().print(table)
    if page is not None:
        write_real_page(outcomes, page, format_measured(date.today(), " and ".join(commits)))
        console().print(f"{page} written", soft_wrap=True)
