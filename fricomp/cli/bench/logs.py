"""`fricomp bench logs`: what comes of logs with flaws, one or two at a time."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)

_FULL, _QUICK = 2000, 210
"""Logs; the latter are each flaw alone and each pair once."""


@app.command(epilog="fricomp bench logs --quick --out runs/logs")
def logs(
    out: Annotated[Path, typer.Option(help="Folder for figures.json.")] = Path("runs/bench_logs"),
    quick: Annotated[bool, typer.Option("--quick", help="Each flaw and each pair once.")] = False,
    count: Annotated[int | None, typer.Option(min=1, help="Number of logs; 2000 by default.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first logs.")] = 22,
    overwrite: Overwrite = False,
) -> None:
    """Put twenty flaws into good logs, singly and in pairs: the right friction comes out, or a flaw is named."""
    from collections import Counter

    from fricomp.cli.terminal import console, progress
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.logs.trial import list_cases, try_case
    from fricomp.whole_file import write_json

    with claim_file(out / "figures.json", overwrite=overwrite):
        total = count or (_QUICK if quick else _FULL)
        trials = []
        with progress() as bar:
            task = bar.add_task("logs", total=total)
            for case in list_cases(total, seed):
                trials.append(try_case(*case))
                bar.advance(task)
        outcomes = Counter(trial.outcome for trial in trials)
        missed = [trial for trial in trials if not trial.is_good]
        figures = {"logs": total, "seed": seed, "outcomes": outcomes, "missed": missed}
        write_json(out / "figures.json", figures)
    show = console()
    good = total - len(missed)
    show.print(f"{good} of {total} logs ({100.0 * good / total:.2f} %) gave the right friction or named a flaw.")
    show.print(", ".join(f"{name}: {number}" for name, number in sorted(outcomes.items())))
    for trial in missed:
        flaws = " + ".join(trial.flaws)
        show.print(f"{trial.outcome}: {flaws} at {trial.rate:g} Hz, seed {trial.seed}: {trial.said}", markup=False)
    show.print(f"Figures in {out}")
