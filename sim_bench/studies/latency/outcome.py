"""Cost of the compensator and timing of the loop, as one outcome."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.control import LoopResult, RealTimeOptions
from fricomp.control.loop.loop_charts import timing_chart
from fricomp.report import Bars, Chart, Panel, Section, Table

from ..kit.outcome import StudyOutcome
from .compensator import Cost, measure_c, measure_costs, measure_growth, measure_import_ratio, measure_network
from .loop_timing import run_loop

N_STEPS = 5
"""Number of steps of the study that `step` is called after."""


def measure_latency(*, quick: bool, priority: int, step: Callable[[], None]) -> StudyOutcome:
    """Measure costs in units of a bare Stribeck curve, memory growth, and the timing of a 1 kHz loop.

    Args:
        quick: Fewer calls and ticks.
        priority: FIFO priority of the real-time run; 0 for none.
        step: Called after each step.
    """
    costs = measure_costs(1_000 if quick else 5_000)
    step()
    with tempfile.TemporaryDirectory() as folder:
        costs += measure_network(Path(folder), 200 if quick else 1_000)
    generated = measure_c()
    costs += [generated] if generated is not None else []
    step()
    ticks = 50_000 if quick else 1_000_000
    growth = measure_growth(ticks)
    step()
    virtual = run_loop(2.0 if quick else 20.0, real_time=False)
    step()
    options = RealTimeOptions(priority=priority, lock_memory=True)
    real = run_loop(2.0 if quick else 20.0, real_time=True, options=options)
    step()
    ratio = measure_import_ratio()
    figures = {
        "costs": costs,
        "import_over_numpy": ratio,
        "memory_blocks_left": {"ticks": ticks, "blocks": growth},
        "loop": {"virtual": _collect_timing(virtual), "real": _collect_timing(real)},
    }
    notes = (
        f"Memory blocks left by {ticks:,} ticks of seven joints: {growth}.",
        f"`import fricomp` takes {ratio:.2f} times `import numpy` (at most 2).",
    )
    ran = f"Real time: {real.cycles} cycles, {real.skipped} skipped. {', '.join(real.real_time.granted)}."
    loop = Section(
        "1 kHz, seven joints of the stand-in",
        (_tabulate_timing(virtual, real), timing_chart(real.log, 1e-3), ran, *real.real_time.refused),
    )
    summary = ("What a call costs in units of one bare Stribeck curve in pure math, and how late a cycle starts.",)
    sections = (Section("Cost of a call", (_tabulate_costs(costs), _draw_costs(costs), *notes)), loop)
    return StudyOutcome("Latency", summary, figures, sections)


def _collect_timing(result: LoopResult) -> dict[str, Any]:
    system = {"granted": result.real_time.granted, "refused": result.real_time.refused}
    return {"cycles": result.cycles, "skipped": result.skipped, **result.log.timing()._asdict(), **system}


def _tabulate_costs(costs: list[Cost]) -> Table:
    rows = tuple(
        (cost.name, f"{1e6 * cost.seconds:.3f}", f"{cost.units:.2f}", "" if cost.limit is None else f"{cost.limit:g}")
        for cost in costs
    )
    return Table(("what", "µs", "× bare Stribeck", "at most"), rows)


def _tabulate_timing(virtual: LoopResult, real: LoopResult) -> Table:
    v, r = virtual.log.timing(), real.log.timing()
    measured = {
        "library's time a tick, virtual time": (v.busy_p50, v.busy_p999, v.busy_max),
        "library's time a tick, real time": (r.busy_p50, r.busy_p999, r.busy_max),
        "lateness, real time": (r.lateness_p50, r.lateness_p999, r.lateness_max),
    }
    rows = tuple((name, *(f"{1e6 * value:.1f}" for value in values)) for name, values in measured.items())
    return Table(("what", "p50 [µs]", "p99.9 [µs]", "max [µs]"), rows)


def _draw_costs(costs: list[Cost]) -> Chart:
    """Cost of each call in units of a bare Stribeck curve, beside its limit."""
    names = tuple(cost.name for cost in costs)
    marks = (
        Bars(names, np.array([cost.units for cost in costs]), "measured"),
        Bars(names, np.array([cost.limit if cost.limit is not None else np.nan for cost in costs]), "at most"),
    )
    return Chart("costs", "Cost of a call", (Panel(marks, "", "× bare Stribeck in math", y_scale="log"),))
