"""What every call of the proof does: its cases diagnosed with progress, its figures on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..figure_table import make_figure_table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fricomp.sim_bench.studies.proof import PlannedCase, RunSettings, Score


def work_through(
    settings: RunSettings, out: Path, executor: tuple[str, int | None], minutes: float | None
) -> tuple[list[Score], Sequence[PlannedCase]]:
    """All scores of the run in its folder, and what it was to be."""
    from time import monotonic

    from fricomp.cli.terminal import console, progress, resumable
    from fricomp.fleet import open_executor
    from fricomp.sim_bench.studies.proof import (
        count_open,
        run_proof,
        stop_after,
    )

    go_on = stop_after(minutes)
    start, done = monotonic(), 0
    with resumable(out), progress() as bar, open_executor(*executor) as pool:
        task = bar.add_task("concealed cases", total=None)

        def count(score: Score | None) -> None:
            nonlocal done
            done += 1
            bar.advance(task)

        def go(planned: Sequence[PlannedCase]) -> list[Score]:
            bar.update(task, total=len(planned), completed=len(planned) - count_open(planned, out))
            return run_proof(planned, out, pool, salt=settings.salt, progress=count, go_on=go_on)

        planned = _plan(settings, out, go)
        scores = go(planned)
    left, spent = count_open(planned, out), (monotonic() - start) / 60.0
    if done:
        rest = f"; the {left} left would take {left * spent / done:.0f} min" if left else ""
        console().print(f"{done} cases in {spent:.1f} min, {done / spent:.2f} a minute{rest}", soft_wrap=True)
    return scores, planned


def _plan(
    settings: RunSettings, out: Path, go: Callable[[Sequence[PlannedCase]], list[Score]]
) -> Sequence[PlannedCase]:
    """The cases; where effects are injected, the recordings are diagnosed as they are first."""
    from fricomp.errors import RecordingError
    from fricomp.sim_bench.studies.proof import count_open, draw_seeds, plan_bare, plan_injected, plan_run

    if not settings.injected:
        return plan_run(settings)
    bare = plan_bare()
    if not bare:
        raise RecordingError("no public recordings are here: set FRICOMP_DATA to the folder that holds them")
    scores = go(bare)
    if count_open(bare, out):  # time is over; what is injected depends on all of them
        return bare
    return [*bare, *plan_injected(scores, draw_seeds(settings))][: settings.cases]


def show_scores(scores: Sequence[Score], planned: Sequence[PlannedCase], out: Path) -> None:
    """Print the figures, and write the wrong answers down."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.proof import compute_figures, count_open, format_failures, read_refused
    from fricomp.whole_file import write_whole

    write_whole(out / "failures.md", format_failures(scores))
    screen, left, refused = console(), count_open(planned, out), len(read_refused(out))
    screen.print(make_figure_table(compute_figures(scores)))
    screen.print(f"{len(scores)} cases in {out}; wrong answers in {out / 'failures.md'}", soft_wrap=True)
    if refused:
        screen.print(f"{refused} cases could not be made; {out / 'refused.jsonl'} says why", soft_wrap=True)
    if left:
        screen.print(f"{left} of {len(planned)} cases are left: --resume goes on", soft_wrap=True)
