"""`fricomp bench mismatch speed-up`: how much faster two workers diagnose than one."""

from pathlib import Path
from typing import Annotated

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)

_EPILOG = "fricomp bench mismatch speed-up --cases 4 --out runs/speed"
_OUT = Path("runs/speed")


@app.command(epilog=_EPILOG)
def speed_up(
    out: Annotated[Path, typer.Option(help="Folder for `speed_up.json`.")] = _OUT,
    cases: Annotated[int, typer.Option(min=2, help="Number of cases, 30 s each.")] = 4,
    first_seed: Annotated[int, typer.Option(help="First development seed.")] = 0,
    overwrite: Overwrite = False,
) -> None:
    """Diagnose the same concealed cases with one worker and with two, beside plain loops that share nothing."""
    from dataclasses import asdict

    from fricomp.cli.terminal import console, progress
    from fricomp.results import claim_file
    from fricomp.sim_bench.studies.proof import RunSettings, measure_speed_up, plan_run
    from fricomp.whole_file import write_json

    with claim_file(out / "speed_up.json", overwrite=overwrite):
        planned = plan_run(RunSettings(cases, quick=True, first_seed=first_seed))
        with progress() as bar:
            task = bar.add_task("one worker and two", total=len(planned))
            found = measure_speed_up(planned, progress=lambda: bar.advance(task))
        figures = asdict(found) | {"ratio": found.ratio, "ratio_free": found.ratio_free}
        write_json(out / "speed_up.json", figures)
    console().print(str(found), soft_wrap=True)
