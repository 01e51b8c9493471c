"""What both commands on sealed arms print and write."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..figure_table import make_figure_table

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.arms import ArmScore
    from fricomp.sim_bench.studies.proof import RunSettings


def show_scores(scores: Sequence[ArmScore]) -> None:
    """Print the figures."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.arms import compute_figures

    console().print(make_figure_table(compute_figures(scores)))


def write_run_page(scores: Sequence[ArmScore], settings: RunSettings, page: Path) -> None:
    """Write the page, with the command that makes the run."""
    from fricomp.cli.terminal import console
    from fricomp.sim_bench.studies.arms import write_page

    kind = "--scored" if settings.scored else f"--first-seed {settings.first_seed}"
    command = f"fricomp bench arms run {kind} --cases {settings.cases} --page docs/{page.name} --out runs/arms"
    write_page(scores, settings, page, command)
    console().print(f"{page} written", soft_wrap=True)
