"""How the benchmarks of known joints print and keep their scores."""

import platform
from pathlib import Path
from typing import Any

from fricomp.cli.terminal import Table
from fricomp.report import Chart, draw_png
from fricomp.sim_bench.studies.identification.seed_study import SeedStudy
from fricomp.whole_file import write_json

_WIDTH = 27
"""Of the longest parameter, in characters."""


def seed_table(study: SeedStudy, title: str, *, profiles: bool = False) -> Table:
    """One row a parameter: its error, that in standard deviations, and how many intervals hold the truth.

    Args:
        study: The scores.
        title: Of the table.
        profiles: Whether to count intervals by profile likelihood too.
    """
    table = Table(title=title, title_justify="left")
    heads = ("parameter", "mean |error|", "RMS error / sd", "in 95 % interval")
    for heading in (*heads, "by profile likelihood") if profiles else heads:
        table.add_column(heading, justify="right")
    table.columns[0].justify, table.columns[0].no_wrap, table.columns[0].min_width = "left", True, _WIDTH
    for name in study.names:
        scores = study.of(name)
        held = f"{sum(s.covered for s in scores)} of {len(scores)}"
        short, spread = name.removeprefix("stribeck."), f"{study.root_mean_square(name):.2f}"
        known = [s.profiled for s in scores if s.profiled is not None]
        profile = [f"{sum(known)} of {len(known)}" if known else ""] if profiles else []
        table.add_row(short, f"{study.mean_error(name):.3%}", spread, held, *profile)
    return table


def save_scores(record: dict[str, Any], chart: Chart, path: Path) -> None:
    """Write `path`.json, with the machine that made it, and `path`.png."""
    record = record | {"machine": platform.platform(), "python": platform.python_version()}
    write_json(path.with_suffix(".json"), record)
    draw_png(chart, path.with_suffix(".png"))
