"""Page, pictures and figures written from the ledger."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fricomp.report import draw_png
from fricomp.whole_file import write_json

from ..kit.page import replace_page
from ..kit.store import RowStore
from .charts import draw_benchmark_charts
from .page import format_identification_page
from .problem import NOISE_READINGS
from .rival_summary import summarise_noise_free, summarise_searches
from .summary import summarise_outliers, summarise_statistics
from .targets import judge_targets
from .timing import summarise_timing


def publish(ledger: RowStore, pages: Sequence[Path], command: str) -> None:
    """Write each page, and beside it a folder of its name with the pictures and `figures.json`.

    Args:
        ledger: Finished draws.
        pages: Markdown files to write.
        command: What the page says wrote it.
    """
    charts = draw_benchmark_charts(ledger)
    figures = _collect_figures(ledger)
    for path in pages:
        folder = path.with_suffix("")
        write_json(folder / "figures.json", figures)
        for chart in charts:
            draw_png(chart, folder / f"{chart.name}.png")
        replace_page(path, format_identification_page(ledger, charts, command, folder.name), "paper")


def _collect_figures(ledger: RowStore) -> dict[str, Any]:
    single = ("departure", "loads", "further")
    return {study: [row["figures"] for row in ledger.rows(study=study)] for study in single} | {
        "targets": judge_targets(ledger),
        "noise_free": summarise_noise_free(ledger),
        "pinn": {reading: summarise_statistics(ledger, reading) for reading in NOISE_READINGS},
        "searches": {reading: summarise_searches(ledger, reading) for reading in NOISE_READINGS},
        "times": summarise_timing(ledger),
        "outliers": {reading: summarise_outliers(ledger, reading) for reading in NOISE_READINGS},
    }
