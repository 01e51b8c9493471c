"""`fricomp evaluate`: how well a model predicts a recording, in torque and in motion."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(add_completion=False)

_EXAMPLES = """fricomp evaluate runs/why elbow.csv --from 40

fricomp evaluate friction.json elbow.csv --simulation robot.xml --joint elbow

fricomp evaluate runs/why/friction.xml elbow.csv --json

Take a recording, or a part of one, that the fit did not see: on its own data every model looks good.

docs/evaluation.md says how each figure is made.
"""


@app.command(epilog=_EXAMPLES)
def evaluate(
    model: Annotated[
        Path,
        typer.Argument(
            help="friction.json, friction.onnx, an MJCF or URDF file, or the folder of a diagnosis (its friction.json)."
        ),
    ],
    recording: Annotated[Path, typer.Argument(help="Recording (CSV or Parquet: time, position, torque).")],
    simulation: Annotated[
        Path | None,
        typer.Option(help="MJCF or URDF with the inertia and gravity of a model that holds friction alone."),
    ] = None,
    joint: Annotated[
        str | None, typer.Option(help="Name of the joint; needed where the simulation has several others.")
    ] = None,
    start: Annotated[float | None, typer.Option("--from", help="Time from which errors count [s].")] = None,
    stop: Annotated[float | None, typer.Option("--to", help="Time up to which errors count [s].")] = None,
    band: Annotated[
        float | None,
        typer.Option(help="Upper end of the band of the torque error [Hz]; chosen from the noise without it."),
    ] = None,
) -> None:
    """Measure a model on a recording: torque error in a band, and open-loop position error after 0.1, 0.5 and 2 s."""
    from math import inf

    from fricomp.cli.output import answer
    from fricomp.cli.terminal import console, make_table
    from fricomp.errors import ParameterError
    from fricomp.evaluation import evaluate as evaluate_model
    from fricomp.recording.sources.reader import SUFFIXES

    of_logs = SUFFIXES.keys() - {".json"}  # which a model has as well
    if model.suffix.lower() in of_logs and recording.suffix.lower() not in of_logs:
        raise ParameterError(f"the model comes first: 'fricomp evaluate {recording} {model}'")
    spans = (
        None if start is None and stop is None else [(-inf if start is None else start, inf if stop is None else stop)]
    )
    found = evaluate_model(model, recording, simulation=simulation, joint=joint, spans=spans, band=band)
    show, overview = console(), found.overview()
    show.print(overview.title, style="bold", markup=False)
    for sentence in overview.sentences:
        show.print(sentence, markup=False)
    for table in overview.tables:
        if table.rows:
            show.print(make_table(table.heads, table.rows))
    answer(found.to_json())
