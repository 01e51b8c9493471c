"""`fricomp bench calibrate`: the whole calibration on the default stand-in joint, over several seeds."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench calibrate --out runs/bench-calibrate")
def calibrate(
    out: Annotated[Path, typer.Option(help="Folder of the results and of one run a seed.")] = Path("runs/bench"),
    seeds: Annotated[int, typer.Option(min=1, help="Number of seeds.")] = 10,
    first_seed: Annotated[int, typer.Option(help="First seed.")] = 0,
    quick: Annotated[bool, typer.Option("--quick", help="Two seeds.")] = False,
    overwrite: Overwrite = False,
) -> None:
    """Calibrate the default stand-in joint once a seed: error, error in standard deviations, coverage."""
    from fricomp.cli.bench.seed_table import save_scores, seed_table
    from fricomp.cli.terminal import console, progress
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.identification.calibrations import study_calibrations

    with claim_file(out / "bench-calibrate.json", overwrite=overwrite):
        with progress() as bar:
            task = bar.add_task("starting", total=1.0)
            study = study_calibrations(
                range(first_seed, first_seed + (2 if quick else seeds)),
                out,
                lambda text, done: bar.update(task, description=text, completed=done),
            )
        console().print(seed_table(study, f"{len(study.statuses)} seeds, default joint"))
        console().print(f"Coverage {study.coverage():.1%}; identifications: {', '.join(sorted(set(study.statuses)))}")
        chart = study.chart("Calibrations of the default joint, one point a seed")
        save_scores(study.to_builtins(), chart, out / "bench-calibrate")
