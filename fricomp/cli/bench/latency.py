"""`fricomp bench latency`: cost of the compensator and lateness of the loop."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench latency --out runs/latency")
def latency(
    out: Annotated[Path, typer.Option(help="Folder for figures.json, plots and report.")] = Path("runs/bench_latency"),
    quick: Annotated[bool, typer.Option("--quick", help="Fewer calls and ticks.")] = False,
    priority: Annotated[int, typer.Option(help="FIFO priority of the real-time run; 0 for none.")] = 80,
    overwrite: Overwrite = False,
) -> None:
    """Costs in units of a bare Stribeck curve in pure math, memory growth, and the timing of a 1 kHz loop."""
    from fricomp.cli.bench.outcome import claim_study, end_study
    from fricomp.cli.terminal import progress
    from fricomp.sim_bench.studies.kit.outcome import write_outcome
    from fricomp.sim_bench.studies.latency.outcome import N_STEPS, measure_latency

    with claim_study(out, overwrite=overwrite):
        with progress() as bar:
            task = bar.add_task("latency", total=N_STEPS)
            outcome = measure_latency(quick=quick, priority=priority, step=lambda: bar.advance(task))
        write_outcome(outcome, out)
    end_study(outcome, out)
