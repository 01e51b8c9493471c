"""`fricomp bench motion`: whether the intervals of friction from a recorded motion hold the truth."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench motion --seeds 40 --out runs/bench-motion")
def motion(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("runs/bench"),
    seeds: Annotated[int, typer.Option(min=1, help="Number of joints.")] = 40,
    first_seed: Annotated[int, typer.Option(help="First seed.")] = 0,
    quick: Annotated[bool, typer.Option("--quick", help="Two joints.")] = False,
    overwrite: Overwrite = False,
) -> None:
    """Identify joints drawn at random from a recorded motion: error, error in standard deviations, coverage.

    A recording is 20 s at 500 Hz of three swings, by an encoder of 18 bits, with torque noise of 0.5 to 2 % of the
    static torque. What holds the truth is counted by the covariance and, for the parameters of the bend, by the
    profile likelihood, which is the interval to read there.
    """
    from fricomp.cli.bench.seed_table import save_scores, seed_table
    from fricomp.cli.terminal import console, progress
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.identification.motions import study_motions

    with claim_file(out / "bench-motion.json", overwrite=overwrite):
        with progress() as bar:
            task = bar.add_task("starting", total=1.0)
            study = study_motions(
                range(first_seed, first_seed + (2 if quick else seeds)),
                lambda text, done: bar.update(task, description=text, completed=done),
            )
        statuses = study.all.statuses
        counts = ", ".join(f"{statuses.count(status)} {status}" for status in dict.fromkeys(sorted(statuses)))
        console().print(f"{len(statuses)} recordings: {counts}")
        for name, part in study._asdict().items():
            if not part.statuses:
                continue
            console().print(seed_table(part, f"{name} ({len(part.statuses)})", profiles=True))
            held = f"{sum(s.held for s in part.scores)} of {len(part.scores)}"
            console().print(f"Hold the truth, by profile likelihood where there is one: {held}")
        record = {name: part.to_builtins() for name, part in study._asdict().items() if part.statuses}
        save_scores(
            record, study.all.chart("Joints from a recorded motion, one point a recording"), out / "bench-motion"
        )
