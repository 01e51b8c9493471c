"""`fricomp bench arms page`: the page of a run, written again without running anything."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench arms page --out runs/arms --page docs/arms-proof.md")
def page(
    out: Annotated[Path, typer.Option(help="Folder of the run.")],
    page: Annotated[Path, typer.Option(help="Page to write, such as docs/arms-proof.md.")],
) -> None:
    """Write the page of a run, by the scoring of today."""
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.arms import read_arm_scores
    from fricomp.sim_bench.studies.proof.settings import SETTINGS, read_settings

    from .show import show_scores, write_run_page

    if not (out / SETTINGS).exists():
        raise DiagnosisError(f"{out} holds no run: give the --out of 'fricomp bench arms run'")
    scores = read_arm_scores(out)
    show_scores(scores)
    write_run_page(scores, read_settings(out / SETTINGS), page)
