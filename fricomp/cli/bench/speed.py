"""`fricomp bench speed`: how long everything takes, in units of a fixed amount of arithmetic."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench speed --quick --out runs/speed\n\nfricomp bench speed --page docs/speed.md")
def speed(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and growth.png.")] = Path("runs/bench_speed"),
    quick: Annotated[bool, typer.Option("--quick", help="Shorter recordings and smaller tables.")] = False,
    page: Annotated[Path | None, typer.Option(help="Write this page, such as docs/speed.md.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Diagnoses, identifications and files, their growth, a profile, and other packages on the same data."""
    import tempfile
    from datetime import date

    from fricomp.cli.terminal import console, make_table, progress
    from fricomp.report import draw_png
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.kit.commit import find_commit, format_measured
    from fricomp.sim_bench.studies.speed.measure import measure_speed
    from fricomp.sim_bench.studies.speed.page import draw_growth, list_rows, write_page
    from fricomp.whole_file import write_json

    with claim_file(out / "figures.json", overwrite=overwrite):
        with progress() as bar, tempfile.TemporaryDirectory() as folder:
            task = bar.add_task("speed", total=None)
            figures = measure_speed(Path(folder), quick=quick, progress=lambda what: bar.update(task, description=what))
        write_json(out / "figures.json", figures)
        draw_png(draw_growth(figures.growth), out / "growth.png")
    heads = ("what", "units", "processor [s]", "passed [s]", "simulated joints")
    console().print(make_table(heads, list_rows(figures.timings)))
    for one in figures.peers:
        console().print(f"{one.name}: {one.units:.3g} units, {one.of_ours:.3g} times {one.ours}", soft_wrap=True)
    if page is not None:
        command = f"fricomp bench speed{' --quick' if quick else ''}"
        write_page(figures, page, format_measured(date.today(), find_commit()), command)
    console().print(f"Figures in {out}")
