"""`fricomp bench mismatch page`: the page of a run, written again without running anything."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(add_completion=False)

_EPILOG = """fricomp bench mismatch page --out runs/mismatch --page docs/proof.md

fricomp bench mismatch page --out runs/again --page docs/proof.md   # from the data beside the page"""


@app.command(epilog=_EPILOG)
def page(
    out: Annotated[Path, typer.Option(help="Folder of the run; a new one is filled from the data beside the page.")],
    page: Annotated[Path, typer.Option(help="Page to write, such as docs/proof.md.")],
) -> None:
    """Write the page of a run, by the scoring of today where its answers and diagnoses are there."""
    from fricomp.errors import DiagnosisError
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.proof import read_scores, restore_data
    from fricomp.sim_bench.studies.proof.run import ANSWERS
    from fricomp.sim_bench.studies.proof.settings import SETTINGS, read_settings

    from . import write

    require_own_page(page, "proof")
    with claim_run(out, ANSWERS):
        restore_data(page.with_suffix(""), out)
        if not (out / SETTINGS).exists():
            raise DiagnosisError(f"{out} holds no run, and none is kept beside {page}: give the --out of a run")
        settings = read_settings(out / SETTINGS)
        write.write_run_page(page, settings, read_scores(out), settings.cases, out, "")
