"""`fricomp bench paper`: tables III to VIII of [luo2024pinn] with ours beside, over many seeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Callable

    from fricomp.calibration.benchmark.study import Ledger

__all__ = ["app", "paper"]

app = typer.Typer()


@dataclass(frozen=True)
class _Sizes:
    """How many draws of everything."""

    noise_free: int
    pinn: int
    optima: int
    outliers: int
    full_searches: int
    tenth_searches: int
    adam_steps: int
    departure: int
    lugre: int


_QUICK = _Sizes(5, 20, 200, 5, 0, 2, 500, 1, 1)
_FULL = _Sizes(100, 2000, 2000, 200, 20, 200, 50_000, 3, 3)


@app.command(
    epilog="fricomp bench paper --quick --out runs/paper\n\n"
    "fricomp bench paper --out runs/paper --docs docs/identification.md"
)
def paper(
    out: Annotated[Path, typer.Option(help="Folder for the ledger, the page, figures and figures.json.")] = Path(
        "runs/bench_paper"
    ),
    quick: Annotated[bool, typer.Option(help="A size that CI can carry.")] = False,
    docs: Annotated[Path | None, typer.Option(help="Write the page here as well.")] = None,
    page_only: Annotated[bool, typer.Option("--page-only", help="No new draws: the page from the ledger.")] = False,
) -> None:
    """Repeat the paper's comparison. Finished draws are kept in OUT/ledger.jsonl, and a second call goes on there."""
    from fricomp.calibration.benchmark.study import Ledger
    from fricomp.cli.terminal import console, progress

    out.mkdir(parents=True, exist_ok=True)
    ledger, sizes = Ledger(out / "ledger.jsonl"), _QUICK if quick else _FULL
    with progress() as bar:
        task = bar.add_task("starting", total=None)

        def report(text: str) -> None:
            bar.update(task, description=text)

        if not page_only:
            _run(ledger, sizes, report)
        report("page and charts")
        page = _write(ledger, out, "fricomp bench paper" + (" --quick" if quick else ""))
    if docs is not None:
        docs.write_text(page, encoding="utf-8")
    console().print(f"Page {out / 'identification.md'}, figures {out / 'figures.json'} and *.png")


def _run(ledger: Ledger, sizes: _Sizes, report: Callable[[str], None]) -> None:
    from fricomp.calibration.benchmark import study

    study.run_noise_free(ledger, sizes.noise_free, report)
    study.run_optima(ledger, sizes.optima, report)
    study.run_departure(ledger, sizes.departure, report)
    study.run_extras(ledger, 20 * sizes.departure, sizes.lugre, report)
    study.run_statistics(ledger, sizes.pinn, report)
    study.run_outliers(ledger, sizes.outliers, report)
    study.run_searches(ledger, sizes.full_searches, sizes.tenth_searches, report)
    study.run_adam_study(ledger, sizes.adam_steps, report)


def _write(ledger: Ledger, out: Path, command: str) -> str:
    """Page, figures as JSON, charts as PNG."""
    import msgspec

    from fricomp.calibration.benchmark.charts import benchmark_charts
    from fricomp.calibration.benchmark.page import identification_page
    from fricomp.calibration.benchmark.problem import NOISE_READINGS
    from fricomp.calibration.benchmark.summary import (
        summarise_noise_free,
        summarise_outliers,
        summarise_searches,
        summarise_statistics,
    )
    from fricomp.report import draw_png

    page = identification_page(ledger, command)
    (out / "identification.md").write_text(page, encoding="utf-8")
    extra = ("optima", "departure", "extras")
    figures = {study: [row["figures"] for row in ledger.rows(study=study)] for study in extra} | {
        "noise_free": summarise_noise_free(ledger),
        "pinn": {r: summarise_statistics(ledger, r) for r in NOISE_READINGS},
        "searches": {r: summarise_searches(ledger, r) for r in NOISE_READINGS},
        "outliers": {r: summarise_outliers(ledger, r) for r in NOISE_READINGS},
    }
    (out / "figures.json").write_bytes(msgspec.json.format(msgspec.json.encode(figures)))
    for chart in benchmark_charts(ledger):
        draw_png(chart, out / f"{chart.name}.png")
    return page
