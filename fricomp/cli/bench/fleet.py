"""`fricomp bench fleet`: how many joints a second are identified in one call."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(
    epilog="fricomp bench fleet --quick --out runs/fleet\n\nfricomp bench fleet --device cuda --out runs/fleet"
)
def fleet(
    out: Annotated[Path, typer.Option(help="Folder for throughput.json.")],
    quick: Annotated[bool, typer.Option("--quick", help="500 joints.")] = False,
    joints: Annotated[int | None, typer.Option(min=1, help="Joints identified in one call; 5000 by default.")] = None,
    single: Annotated[int, typer.Option(min=1, help="Joints identified one by one, for comparison.")] = 100,
    device: Annotated[str, typer.Option(help="torch device: cpu, cuda.")] = "cpu",
    seed: Annotated[int, typer.Option(help="Seed of the fleet.")] = 0,
    overwrite: Overwrite = False,
) -> None:
    """Identify a fleet of joints in one call and one by one; rates, their ratio, and that both agree."""
    from fricomp.cli.terminal import console
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.identification.throughput import measure_throughput
    from fricomp.whole_file import write_json

    with claim_file(out / "throughput.json", overwrite=overwrite):
        found = measure_throughput(joints or (500 if quick else 5000), single=single, seed=seed, device=device)
        figures = asdict(found) | {"ratio": found.ratio}
        write_json(out / "throughput.json", figures)
    console().print(str(found), soft_wrap=True)
