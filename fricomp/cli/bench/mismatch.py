"""`fricomp bench mismatch`: what the diagnosis names in joints whose truth is concealed from it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fricomp.sim_bench.proof import PlannedCase, RunSettings, Score

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench mismatch --quick --out runs/mismatch

fricomp bench mismatch --scored --cases 2000 --minutes 60 --resume --page docs/proof.md --out runs/scored

fricomp bench mismatch --cases 200 --executor dask://scheduler:8786 --out runs/mismatch

fricomp bench mismatch --nulls --cases 300 --first-seed 50000 --out runs/nulls

fricomp bench mismatch --injected --page docs/injected.md --out runs/injected

fricomp bench mismatch --gap 24 --first-seed 810000 --page docs/proof.md --out runs/gap

fricomp bench mismatch --replay 26 --verify

fricomp bench mismatch --replay 26 --out runs/replay

fricomp bench mismatch --close "the diagnosis was changed"

fricomp bench mismatch --quick --speed-up 4 --out runs/speed"""
_QUICK, _FULL = 12, 2000
_OUT = Path("runs/mismatch")
_LOG = Path("docs/proof/runs.jsonl")


@app.command(epilog=_EPILOG)
def mismatch(
    out: Annotated[Path, typer.Option(help="Folder for seals, answers, diagnoses and scores.")] = _OUT,
    quick: Annotated[bool, typer.Option("--quick", help=f"{_QUICK} cases of 30 s.")] = False,
    clear: Annotated[bool, typer.Option("--clear", help="Every effect once, clear, 30 s, with nulls between.")] = False,
    nulls: Annotated[bool, typer.Option("--nulls", help="Only cases in which nothing is missing.")] = False,
    injected: Annotated[bool, typer.Option("--injected", help="Effects in real recordings; needs the data.")] = False,
    cases: Annotated[int | None, typer.Option(min=1, help=f"How many; {_FULL} by default.")] = None,
    minutes: Annotated[float | None, typer.Option(min=0.0, help="Start no case after this; --resume goes on.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the run in OUT, else beside PAGE.")] = False,
    scored: Annotated[bool, typer.Option("--scored", help="Seeds that follow from the committed diagnosis.")] = False,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    executor: Annotated[str, typer.Option(help="processes://N, serial or dask://host:port.")] = "processes",
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")] = None,
    baselines: Annotated[int, typer.Option(min=0, help="Try the other methods on this many of the cases.")] = 0,
    speed_up: Annotated[int, typer.Option(min=0, help="Only time this many cases with one worker and with two.")] = 0,
    gap: Annotated[int, typer.Option(min=0, help="Only measure the held-out gap closed, on this many.")] = 0,
    replay: Annotated[int, typer.Option(min=0, help="Make scored run N again from what is kept; not logged.")] = 0,
    verify: Annotated[bool, typer.Option("--verify", help="With --replay: only check its answers' seals.")] = False,
    close: Annotated[str | None, typer.Option(help="End the kept scored run with this reason; run nothing.")] = None,
    log: Annotated[Path, typer.Option(help="Log of the scored runs, their data beside it.")] = _LOG,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/proof.md.")] = None,
) -> None:
    """Conceal physics in joints, diagnose them blind, and score the answers.

    Cases are interleaved: any beginning of a run is a fair sample of the whole, and a run that was stopped goes on.
    """
    from fricomp.sim_bench.proof import RunSettings, load_or_start, load_replay, plan_run, restore_data

    from . import mismatch_kept, mismatch_page

    pool = (executor, workers)
    if close is not None or verify:
        mismatch_kept.only(close, replay, log, pool)
        return
    _refuse(replay, page, log, gap, others=clear or injected or scored, nulls=nulls)
    number = cases or (_QUICK if quick else _FULL)
    wanted = RunSettings(number, quick, clear, scored, first_seed, injected=injected, nulls=nulls)
    if gap:
        _measure_gaps(gap, wanted, out, pool, page)
        return
    if speed_up:
        _time_workers(plan_run(wanted)[:speed_up], out)
        return
    if replay:
        settings = load_replay(replay, out, log, Path.cwd(), cases)
    else:
        if resume and page is not None:
            restore_data(page.with_suffix(""), out)
        settings = load_or_start(out, wanted, resume=resume, log=log, repository=Path.cwd())
    scores, planned = _run(settings, out, pool, minutes, log)
    others = _compare(planned[:baselines], out, pool, scores, settings.tree)
    _show(scores, planned, out)
    if page is not None:
        mismatch_page.write(page, settings, scores, len(planned), out, others, log)


def _refuse(replay: int, page: Path | None, log: Path, gap: int, *, others: bool, nulls: bool) -> None:
    """Nothing, where the options go together.

    Raises:
        DiagnosisError: They do not.
    """
    from fricomp.errors import DiagnosisError

    if replay and page is not None and page.with_suffix("").resolve() == log.parent.resolve():
        raise DiagnosisError(f"{page} is of the run itself: give the replay a --page of its own, or none")
    if replay and (others or nulls or gap):
        raise DiagnosisError("--replay takes the cases of a scored run: leave out what chooses others")
    if nulls and others:
        raise DiagnosisError("nulls alone come from development seeds: leave out --clear, --injected and --scored")
    if gap and (others or nulls):
        raise DiagnosisError("--gap takes cases of its own, of development seeds: leave out what chooses others")


def _measure_gaps(
    number: int, settings: RunSettings, out: Path, executor: tuple[str, int | None], page: Path | None
) -> None:
    """What is closed of the held-out gap, in `out` and beside the page, which shows it when it is next written."""
    from datetime import date

    from fricomp.cli.terminal import console, progress, resumable
    from fricomp.sim_bench.fleet import open_executor
    from fricomp.sim_bench.proof import GAP, format_gaps, format_stamp, measure_gaps, plan_gaps, seeds_of

    planned = plan_gaps(number, seeds_of(settings), 30.0 if settings.quick else None)
    again = resumable(out, "the same command goes on")
    with again, progress() as bar, open_executor(*executor) as pool:
        task = bar.add_task("diagnosed twice", total=number)
        scores = measure_gaps(planned, out / "gap", pool, progress=lambda: bar.advance(task))
    kind = "--quick " if settings.quick else ""
    options = f"--gap {number} {kind}--first-seed {settings.first_seed} --out runs/{out.name}"
    measured = format_stamp(date.today(), Path.cwd())
    text = format_gaps(scores, f"fricomp bench mismatch {options}", measured) + "\n"
    for path in (out / GAP, *((page.with_suffix("") / GAP,) if page is not None else ())):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    console().print(text, soft_wrap=True)


def _time_workers(planned: Sequence[PlannedCase], out: Path) -> None:
    import json
    from dataclasses import asdict

    from fricomp.cli.terminal import console, progress
    from fricomp.sim_bench.proof import measure_speed_up

    with progress() as bar:
        task = bar.add_task("one worker and two", total=len(planned))
        found = measure_speed_up(planned, progress=lambda: bar.advance(task))
    out.mkdir(parents=True, exist_ok=True)
    figures = asdict(found) | {"ratio": found.ratio}
    (out / "speed_up.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    console().print(str(found), soft_wrap=True)


def _run(
    settings: RunSettings, out: Path, executor: tuple[str, int | None], minutes: float | None, log: Path
) -> tuple[list[Score], Sequence[PlannedCase]]:
    """All scores of the run in its folder, and what it was to be."""
    from functools import partial
    from time import monotonic

    from fricomp.cli.terminal import console, progress, resumable
    from fricomp.sim_bench.fleet import open_executor
    from fricomp.sim_bench.proof import check_diagnosis, compute_figures, count_open, log_outcome, run_proof, watch

    go_on, check = watch(settings, Path.cwd(), minutes), partial(check_diagnosis, settings, Path.cwd())
    start, done = monotonic(), 0
    with resumable(out), progress() as bar, open_executor(*executor) as pool:
        task = bar.add_task("concealed cases", total=None)

        def count(score: Score | None) -> None:
            nonlocal done
            done += 1
            bar.advance(task)

        def go(planned: Sequence[PlannedCase]) -> list[Score]:
            bar.update(task, total=len(planned), completed=len(planned) - count_open(planned, out))
            return run_proof(planned, out, pool, salt=settings.salt, progress=count, go_on=go_on, check=check)

        planned = _plan(settings, out, go)
        scores = go(planned)
    left, spent = count_open(planned, out), (monotonic() - start) / 60.0
    if done:
        rest = f"; the {left} left would take {left * spent / done:.0f} min" if left else ""
        console().print(f"{done} cases in {spent:.1f} min, {done / spent:.2f} a minute{rest}", soft_wrap=True)
    log_outcome(settings, log, left, len(scores), {figure.name: figure.value for figure in compute_figures(scores)})
    return scores, planned


def _plan(
    settings: RunSettings, out: Path, go: Callable[[Sequence[PlannedCase]], list[Score]]
) -> Sequence[PlannedCase]:
    """The cases; where effects are injected, the recordings are diagnosed as they are first."""
    from fricomp.errors import RecordingError
    from fricomp.sim_bench.proof import count_open, plan_bare, plan_injected, plan_run, seeds_of

    if not settings.injected:
        return plan_run(settings)
    bare = plan_bare()
    if not bare:
        raise RecordingError("no public recordings are here: set FRICOMP_DATA to the folder that holds them")
    scores = go(bare)
    if count_open(bare, out):  # time is over; what is injected depends on all of them
        return bare
    return [*bare, *plan_injected(scores, seeds_of(settings))][: settings.cases]


def _compare(
    planned: Sequence[PlannedCase], out: Path, executor: tuple[str, int | None], scores: Sequence[Score], tree: str
) -> str:
    """The table of the other methods; that of an earlier call where none is asked for now."""
    from datetime import date

    from fricomp.cli.terminal import progress, resumable
    from fricomp.sim_bench.fleet import open_executor
    from fricomp.sim_bench.proof import BASELINES, format_stamp
    from fricomp.sim_bench.proof.baselines import compare_baselines, format_table

    path = out / BASELINES
    if planned:
        with resumable(out), progress() as bar, open_executor(*executor) as pool:
            task = bar.add_task("other methods", total=len(planned))
            found = compare_baselines(planned, out / "baselines", pool, progress=lambda: bar.advance(task))
        measured = format_stamp(date.today(), Path.cwd(), tree)
        path.write_text(format_table(found, scores, measured) + "\n", encoding="utf-8")
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _show(scores: Sequence[Score], planned: Sequence[PlannedCase], out: Path) -> None:
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.proof import compute_figures, count_open, format_failures, read_refused

    (out / "failures.md").write_text(format_failures(scores), encoding="utf-8")
    show, left, refused = console(), count_open(planned, out), len(read_refused(out))
    show.print(_table(compute_figures(scores)))
    show.print(f"{len(scores)} cases in {out}; wrong answers in {out / 'failures.md'}", soft_wrap=True)
    if refused:
        show.print(f"{refused} cases could not be made; {out / 'refused.jsonl'} says why", soft_wrap=True)
    if left:
        show.print(f"{left} of {len(planned)} cases are left: --resume goes on", soft_wrap=True)


def _table(figures: Sequence[Any]) -> Any:
    from rich.table import Table

    table = Table("figure", "target", "measured (95 % interval)", "reached")
    for figure in figures:
        style = "" if figure.reached is not False else "bold"
        table.add_row(figure.name, figure.target, figure.value, figure.standing, style=style)
    return table
