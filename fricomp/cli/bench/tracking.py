"""`fricomp bench tracking`: what compensation is worth, and where it loses."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

from fricomp.cli.option.panel import Overwrite

app = typer.Typer(add_completion=False)

_QUICK_AXES: dict[str, Any] = {"gain": (0.6, 1.0, 1.3), "scale": (0.7, 1.0, 1.3), "delay": (0.001, 0.008)}


class Part(str, Enum):  # noqa: UP042 - typer shows the values of a str enum
    """Parts of the benchmark."""

    sines = "sines"
    robustness = "robustness"
    loops = "loops"
    close_loop = "close-loop"


@app.command(epilog="fricomp bench tracking --only close-loop --out runs/close_loop")
def tracking(
    out: Annotated[Path, typer.Option(help="Folder for figures.json, plots and report.")] = Path("runs/bench_tracking"),
    quick: Annotated[bool, typer.Option("--quick", help="One amplitude and bandwidth, a coarse map.")] = False,
    only: Annotated[list[Part] | None, typer.Option(help="Only this part; may be repeated.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Tracking on the stand-in, with and without compensation, and where it wins and loses.

    sines: none, tanh-Coulomb-viscous, Stribeck and the default. robustness: maps over gain, friction and delay. loops:
    margins to the limit cycle. close-loop: calibrate, compensate, record, diagnose, compensate with what was found.
    """
    from fricomp.cli.bench.outcome import claim_study, end_study
    from fricomp.cli.terminal import progress
    from fricomp.sim_bench.studies.kit.outcome import write_outcome
    from fricomp.sim_bench.studies.tracking import JOINTS
    from fricomp.sim_bench.studies.tracking.outcome import (
        TrackingPart,
        join_parts,
        study_close_loop,
        study_loops,
        study_robustness,
        study_sines,
    )

    amplitudes, bandwidths = ((0.2,), (5.0,)) if quick else ((0.2, 0.5), (5.0, 10.0))
    each = len(JOINTS) * len(bandwidths)
    done: dict[str, TrackingPart] = {}
    with claim_study(out, overwrite=overwrite):
        with progress() as bar:

            def count(name: str, total: int | None) -> Callable[[], None]:
                task = bar.add_task(name, total=total)
                return lambda: bar.advance(task)

            if not only or Part.sines in only:
                done["tracking"] = study_sines(amplitudes, bandwidths, count("tracking", each * len(amplitudes)))
            if not only or Part.robustness in only:
                axes = _QUICK_AXES if quick else {}
                done["robustness"] = study_robustness(bandwidths, axes, count("robustness", each))
            if not only or Part.loops in only:
                done["loops"] = study_loops(bandwidths, count("loop checks", each))
            if not only or Part.close_loop in only:
                task = bar.add_task("close loop", total=None)
                done["close_loop"] = study_close_loop(
                    bandwidths, out / "close_loop", lambda step: bar.update(task, description=step)
                )
        outcome = join_parts(done)
        write_outcome(outcome, out, numbered=True)
    end_study(outcome, out)
