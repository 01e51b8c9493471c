"""`fricomp bench stand-in`: how truly the simulated joint sticks and slides, and how fast."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench stand-in --quick --out runs/stand_in")
def stand_in(
    out: Annotated[Path, typer.Option(help="Folder for figures.json.")] = Path("runs/bench_stand_in"),
    quick: Annotated[bool, typer.Option("--quick", help="5 s of random motion instead of 60 s.")] = False,
    seed: Annotated[int, typer.Option(help="Seed of the random motion.")] = 0,
    overwrite: Overwrite = False,
) -> None:
    """Measure creep, passivity, Stribeck curve and speed of the default stand-in joint."""
    from fricomp.cli.terminal import Table, console
    from fricomp.results import claim_file
    from fricomp.sim_bench.stand_in import default_joint
    from fricomp.sim_bench.stand_in.figures import measure
    from fricomp.whole_file import write_json

    with claim_file(out / "figures.json", overwrite=overwrite):
        figures = measure(default_joint(), seed=seed, seconds=5.0 if quick else 60.0)
        write_json(out / "figures.json", figures)
    table = Table("what", "measured", "at most", title="Stand-in joint")
    table.add_row("creep under 90 % of breakaway", f"{figures.creep:.2g} rad/s", "1e-4 rad/s")
    table.add_row("friction torque × end-of-step velocity", f"{figures.largest_power:.2g} W", "1e-5 W")
    table.add_row("net work of friction over 10 ms", f"{figures.largest_work:.2g} J", "0 J")
    table.add_row("Stribeck curve in steady sliding", f"{100 * figures.curve_error:.2g} %", "0.5 %")
    table.add_row("simulated over processor time", f"{figures.real_time_factor:.0f}", "at least 50")
    console().print(table)
    console().print(f"Figures in {out / 'figures.json'}")
