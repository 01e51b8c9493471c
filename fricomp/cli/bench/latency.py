"""`fricomp bench latency`: cost of the compensator and lateness of the loop."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.out_folder import Overwrite

if TYPE_CHECKING:
    from fricomp.control import LoopResult
    from fricomp.sim_bench.studies.latency.compensator import Cost

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command(epilog="fricomp bench latency --out runs/latency")
def latency(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and the plots.")] = Path("runs/bench_latency"),
    quick: Annotated[bool, typer.Option(help="Fewer calls and ticks.")] = False,
    priority: Annotated[int, typer.Option(help="FIFO priority of the real-time run; 0 for none.")] = 80,
    overwrite: Overwrite = False,
) -> None:
    """Costs in units of a bare Stribeck curve in pure math, memory growth, and the timing of a 1 kHz loop."""
    import tempfile

    import msgspec

    from fricomp.cli.loop_charts import cost_chart, timing_chart
    from fricomp.cli.terminal import console, progress
    from fricomp.control import RealTimeOptions
    from fricomp.report import draw_png
    from fricomp.results import require_free_file
    from fricomp.sim_bench.studies.latency.compensator import (
        measure_c,
        measure_costs,
        measure_growth,
        measure_import_ratio,
        measure_network,
    )
    from fricomp.sim_bench.studies.latency.loop_timing import run_loop
    from fricomp.whole_file import write_whole

    require_free_file(out / "figures.json", overwrite=overwrite)

    with progress() as bar:
        task = bar.add_task("latency", total=5)
        costs = measure_costs(1_000 if quick else 5_000)
        bar.advance(task)
        with tempfile.TemporaryDirectory() as folder:
            costs += measure_network(Path(folder), 200 if quick else 1_000)
        generated = measure_c()
        costs += [generated] if generated is not None else []
        bar.advance(task)
        ticks = 50_000 if quick else 1_000_000
        growth = measure_growth(ticks)
        bar.advance(task)
        virtual = run_loop(2.0 if quick else 20.0, real_time=False)
        bar.advance(task)
        options = RealTimeOptions(priority=priority, lock_memory=True)
        real = run_loop(2.0 if quick else 20.0, real_time=True, options=options)
        bar.advance(task)
    for chart in (cost_chart(costs), timing_chart(real.log, 1e-3)):
        draw_png(chart, out / f"{chart.name}.png")
    figures = {
        "costs": costs,
        "import_over_numpy": measure_import_ratio(),
        "memory_blocks_left": {"ticks": ticks, "blocks": growth},
        "loop": {"virtual": _timing(virtual), "real": _timing(real)},
    }
    write_whole(out / "figures.json", msgspec.json.format(msgspec.json.encode(figures)))
    _print(costs, (ticks, growth), virtual, real)
    console().print(f"`import fricomp` takes {figures['import_over_numpy']:.2f} times `import numpy` (at most 2).")
    console().print(f"Figures and plots in {out}")


def _timing(result: LoopResult) -> dict[str, Any]:
    timing = result.log.timing()._asdict()
    system = {"granted": result.real_time.granted, "refused": result.real_time.refused}
    return {"cycles": result.cycles, "skipped": result.skipped, **timing, **system}


def _print(costs: list[Cost], growth: tuple[int, int], virtual: LoopResult, real: LoopResult) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    out = console()
    table = Table("what", "µs", "× bare Stribeck", "at most", title="Cost of a call")
    for cost in costs:
        limit = "" if cost.limit is None else f"{cost.limit:g}"
        table.add_row(cost.name, f"{1e6 * cost.seconds:.3f}", f"{cost.units:.2f}", limit)
    out.print(table)
    out.print(f"Memory blocks left by {growth[0]:,} ticks of seven joints: {growth[1]}.")
    table = Table("what", "p50 [µs]", "p99.9 [µs]", "max [µs]", title="1 kHz, seven joints of the stand-in")
    for name, result in (("virtual time", virtual), ("real time", real)):
        t = result.log.timing()
        busy = (t.busy_p50, t.busy_p999, t.busy_max)
        table.add_row(f"library's time a tick, {name}", *(f"{1e6 * value:.1f}" for value in busy))
    t = real.log.timing()
    late = (t.lateness_p50, t.lateness_p999, t.lateness_max)
    table.add_row("lateness, real time", *(f"{1e6 * value:.1f}" for value in late))
    out.print(table)
    out.print(f"Real time: {real.cycles} cycles, {real.skipped} skipped. {', '.join(real.real_time.granted)}.")
    for refused in real.real_time.refused:
        out.print(f"- {refused}")
