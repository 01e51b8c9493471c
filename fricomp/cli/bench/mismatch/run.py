"""`fricomp bench mismatch run`: conceal physics in joints, diagnose them blind, and score the answers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..options import ExecutorOption, WorkersOption, working

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fricomp.sim_bench.studies.proof import PlannedCase, RunSettings, Score

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench mismatch run --quick --out runs/mismatch

fricomp bench mismatch run --scored --cases 2000 --minutes 60 --resume --page docs/proof.md --out runs/scored

fricomp bench mismatch run --cases 200 --executor dask://scheduler:8786 --out runs/mismatch

fricomp bench mismatch run --nulls --cases 300 --first-seed 50000 --out runs/nulls

fricomp bench mismatch run --injected --page docs/injected.md --out runs/injected"""
_QUICK, _FULL = 12, 2000
_OUT = Path("runs/mismatch")


@app.command(epilog=_EPILOG)
def run(
    out: Annotated[Path, typer.Option(help="Folder for seals, answers, diagnoses and scores.")] = _OUT,
    quick: Annotated[bool, typer.Option("--quick", help=f"{_QUICK} cases of 30 s.")] = False,
    clear: Annotated[bool, typer.Option("--clear", help="Every effect once, clear, 30 s, with nulls between.")] = False,
    nulls: Annotated[bool, typer.Option("--nulls", help="Only cases in which nothing is missing.")] = False,
    injected: Annotated[bool, typer.Option("--injected", help="Effects in real recordings; needs the data.")] = False,
    cases: Annotated[int | None, typer.Option(min=1, help=f"Number of cases; {_FULL} by default.")] = None,
    minutes: Annotated[float | None, typer.Option(min=0.0, help="Start no case after this; --resume goes on.")] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue the run in OUT, or without one there, beside PAGE.")
    ] = False,
    scored: Annotated[bool, typer.Option("--scored", help="Seeds from a number drawn as the run begins.")] = False,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    executor: ExecutorOption = "processes",
    workers: WorkersOption = None,
    baselines: Annotated[int, typer.Option(min=0, help="Try the other methods on this many of the cases.")] = 0,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/proof.md.")] = None,
) -> None:
    """Conceal physics in joints, diagnose them blind, and score the answers.

    Cases are interleaved: any beginning of a run is a fair sample of the whole, and a run that was stopped goes on.
    """
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.proof import RunSettings, load_or_start, restore_data
    from fricomp.sim_bench.studies.proof.run import ANSWERS

    from . import work, write

    number = cases or (_QUICK if quick else _FULL)
    wanted = RunSettings(number, quick, clear, scored, first_seed, injected=injected, nulls=nulls)
    _refuse(wanted)
    require_own_page(page, "proof")
    with claim_run(out, ANSWERS):
        if resume and page is not None:
            restore_data(page.with_suffix(""), out)
        settings = load_or_start(out, wanted, resume=resume)
        scores, planned = work.work_through(settings, out, (executor, workers), minutes)
        others = _compare(planned[:baselines], out, (executor, workers), scores)
        work.show_scores(scores, planned, out)
        if page is not None:
            write.write_run_page(page, settings, scores, len(planned), out, others)


def _refuse(wanted: RunSettings) -> None:
    """Nothing, where the options go together.

    Raises:
        DiagnosisError: They do not.
    """
    from fricomp.errors import DiagnosisError

    kinds = [name for name in ("quick", "clear", "nulls", "injected") if getattr(wanted, name)]
    if wanted.scored and kinds:
        raise DiagnosisError(f"a scored run has cases of every kind, at full length: leave out --{kinds[0]}")
    if wanted.nulls and (wanted.clear or wanted.injected):
        raise DiagnosisError("nulls alone are simulated joints of their own: leave out --clear and --injected")


def _compare(
    planned: Sequence[PlannedCase], out: Path, executor: tuple[str, int | None], scores: Sequence[Score]
) -> str:
    """The table of the other methods; that of an earlier call where none is asked for now."""
    from datetime import date

    from fricomp.sim_bench.studies.kit.commit import find_commit, format_measured
    from fricomp.sim_bench.studies.proof import BASELINES
    from fricomp.sim_bench.studies.proof.baselines import compare_baselines, format_table
    from fricomp.whole_file import write_whole

    path = out / BASELINES
    if planned:
        with working("other methods", len(planned), out, *executor) as (pool, count):
            found = compare_baselines(planned, out / "baselines", pool, progress=count)
        measured = format_measured(date.today(), find_commit())
        write_whole(path, format_table(found, scores, measured))
    return path.read_text(encoding="utf-8") if path.exists() else ""
