"""`fricomp bench paper`: tables III to VIII of [luo2024pinn] with ours beside, over many seeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Callable

    from fricomp.sim_bench.studies.kit.store import RowStore

__all__ = ["app", "paper"]

app = typer.Typer(add_completion=False)

LEDGER = "ledger.jsonl"


@dataclass(frozen=True)
class _Sizes:
    """How many draws of everything; of Adam, starts of each spread and steps."""

    noise_free: int
    pinn: int
    outliers: int
    searches: tuple[int, int] | None
    adam: tuple[int, int]
    departure: int
    loads: int
    sweeps: int
    lugre: int


_QUICK = _Sizes(5, 20, 5, (0, 2), (2, 500), 1, 1, 20, 1)
_FULL = _Sizes(100, 2000, 200, None, (20, 50_000), 5, 3, 300, 5)


@app.command(
    epilog="fricomp bench paper --quick --out runs/paper\n\n"
    "fricomp bench paper --out runs/paper --docs docs/identification.md"
)
def paper(
    out: Annotated[Path, typer.Option(help="Folder for the ledger, the page and its figures.")] = Path(
        "runs/bench_paper"
    ),
    quick: Annotated[bool, typer.Option("--quick", help="A size that CI can carry.")] = False,
    docs: Annotated[Path | None, typer.Option(help="Write page and figures here as well.")] = None,
    page_only: Annotated[bool, typer.Option("--page-only", help="No new draws: the page from the ledger.")] = False,
) -> None:
    """Repeat the paper's comparison. Finished draws are kept in OUT/ledger.jsonl, and a second call goes on there."""
    from fricomp.cli.terminal import console, progress
    from fricomp.sim_bench.studies.kit.folder import claim_run
    from fricomp.sim_bench.studies.kit.page import require_own_page
    from fricomp.sim_bench.studies.kit.store import RowStore

    require_own_page(docs, "paper")
    sizes = _QUICK if quick else _FULL
    command = "fricomp bench paper" + " --quick" * quick + (f" --docs {docs}" if docs is not None else "")
    pages = [out / "identification.md", *([docs] if docs is not None else [])]
    with claim_run(out, LEDGER), progress() as bar:
        ledger = RowStore(out / LEDGER)
        task = bar.add_task("starting", total=None)

        def report(text: str) -> None:
            bar.update(task, description=text)

        if not page_only:
            _run(ledger, sizes, report)
        report("page and charts")
        from fricomp.sim_bench.studies.paper.publication import publish

        publish(ledger, pages, command)
    for page in pages:
        console().print(f"Page {page}, figures in {page.with_suffix('')}")


def _run(ledger: RowStore, sizes: _Sizes, report: Callable[[str], None]) -> None:
    """What matters most comes first, for a run that is cut short."""
    from fricomp.sim_bench.studies.paper import rivals, study, timing

    searches = rivals.SearchSizes(*sizes.searches) if sizes.searches else rivals.FULL_SIZES
    study.run_noise_free(ledger, sizes.noise_free, report)
    study.run_as_given(ledger, sizes.noise_free, report)
    study.run_statistics(ledger, sizes.pinn, report)
    rivals.run_adam_study(ledger, *sizes.adam, report)
    timing.run_timing(ledger, sizes.adam[1], report)
    study.run_outliers(ledger, sizes.outliers, report)
    study.run_departure(ledger, sizes.departure, report)
    study.run_extras(ledger, sizes.sweeps, sizes.lugre, report)
    study.run_loads(ledger, sizes.loads, report)
    rivals.run_searches(ledger, searches, report)
