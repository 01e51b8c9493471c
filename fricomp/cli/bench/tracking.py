"""`fricomp bench tracking`: what compensation is worth, and where it loses."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fricomp.cli.out_folder import Overwrite

if TYPE_CHECKING:
    from rich.progress import Progress

    from fricomp.control.loop.loop_check import LoopCheck
    from fricomp.report import Chart
    from fricomp.sim_bench.studies.tracking import RobustnessMap, StudyRow, TrackedJoint
    from fricomp.sim_bench.studies.tracking.close_loop import CloseLoopResult

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_QUICK_AXES: dict[str, Any] = {"gain": (0.6, 1.0, 1.3), "scale": (0.7, 1.0, 1.3), "delay": (0.001, 0.008)}


class Part(str, Enum):  # noqa: UP042 - typer shows the values of a str enum
    """Parts of the benchmark."""

    sines = "sines"
    robustness = "robustness"
    loops = "loops"
    close_loop = "close-loop"


@app.command(epilog="fricomp bench tracking --only close-loop --out runs/close_loop")
def tracking(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and the plots.")] = Path("runs/bench_tracking"),
    quick: Annotated[bool, typer.Option(help="One amplitude and bandwidth, a coarse map.")] = False,
    only: Annotated[list[Part] | None, typer.Option(help="Only this part; may be repeated.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Tracking on the stand-in, with and without compensation, and where it wins and loses.

    sines: none, tanh-Coulomb-viscous, Stribeck and the default. robustness: maps over gain, friction and delay. loops:
    margins to the limit cycle. close-loop: calibrate, compensate, record, diagnose, compensate with what was found.
    """
    import msgspec

    from fricomp.cli.terminal import console, progress
    from fricomp.report import draw_png
    from fricomp.results import require_free_file
    from fricomp.whole_file import write_whole

    require_free_file(out / "figures.json", overwrite=overwrite)

    parts = only or list(Part)
    amplitudes, bandwidths = ((0.2,), (5.0,)) if quick else ((0.2, 0.5), (5.0, 10.0))
    figures: dict[str, Any] = {}
    charts: list[Chart] = []
    with progress() as bar:
        if Part.sines in parts:
            figures["tracking"] = _sines(bar, charts, amplitudes, bandwidths)
        if Part.robustness in parts:
            figures["robustness"] = _robustness(bar, charts, bandwidths, _QUICK_AXES if quick else {})
        if Part.loops in parts:
            figures["loops"] = _loops(bar, charts, bandwidths)
        if Part.close_loop in parts:
            figures["close_loop"] = _close_loop(bar, charts, bandwidths, out / "close_loop")
    for number, chart in enumerate(charts):
        draw_png(chart, out / f"{number:02d}-{chart.name}.png")
    write_whole(out / "figures.json", msgspec.json.format(msgspec.json.encode(figures)))
    console().print(f"Figures and {len(charts)} plots in {out}")


def _sines(bar: Progress, charts: list[Chart], amplitudes: Any, bandwidths: Any) -> list[dict[str, Any]]:
    from fricomp.cli.loop_charts import tracking_charts
    from fricomp.sim_bench.studies.tracking import JOINTS, run_study

    task = bar.add_task("tracking", total=len(JOINTS) * len(amplitudes) * len(bandwidths))
    rows = []
    for row in run_study(tuple(JOINTS.values()), amplitudes, bandwidths):
        rows.append(row)
        bar.advance(task)
    charts += tracking_charts(rows)
    _print_sines(rows)
    return [
        {
            "joint": row.joint.name,
            "amplitude": row.amplitude,
            "bandwidth": row.bandwidth,
            "rms": {method: found.rms for method, found in row.figures.items()},
            "reversal_rms": {method: found.reversal_rms for method, found in row.figures.items()},
        }
        for row in rows
    ]


def _robustness(bar: Progress, charts: list[Chart], bandwidths: Any, axes: dict[str, Any]) -> list[dict[str, Any]]:
    from fricomp.cli.loop_charts import robustness_chart
    from fricomp.sim_bench.studies.tracking import JOINTS, compute_robustness

    task = bar.add_task("robustness", total=len(JOINTS) * len(bandwidths))
    maps = []
    for joint in JOINTS.values():
        for bandwidth in bandwidths:
            maps.append(compute_robustness(joint, bandwidth, **axes))
            bar.advance(task)
    charts += [robustness_chart(found) for found in maps]
    _print_robustness(maps)
    return [
        {
            "joint": found.joint.name,
            "bandwidth": found.bandwidth,
            "share_won": found.share_won,
            "share_helps": found.share_helps,
            **{name: getattr(found, name).tolist() for name in ("gain", "scale", "delay", "ours", "rival")},
            "ours_reversal": found.ours_reversal.tolist(),
            "rival_reversal": found.rival_reversal.tolist(),
        }
        for found in maps
    ]


def _loops(bar: Progress, charts: list[Chart], bandwidths: Any) -> list[dict[str, Any]]:
    from fricomp.cli.loop_charts import gain_scan_chart
    from fricomp.sim_bench.studies.tracking import JOINTS, TrackingCase, check_tracked, run_standstill

    task = bar.add_task("loop checks", total=len(JOINTS) * len(bandwidths))
    checks, found = [], []
    for joint in JOINTS.values():
        for bandwidth in bandwidths:
            check = check_tracked(joint, bandwidth)
            travel = run_standstill(TrackingCase(joint, "default", 0.2, bandwidth))
            checks.append((joint, bandwidth, check, travel))
            charts.append(gain_scan_chart(check, f"{joint.title}, {bandwidth:g} Hz"))
            bar.advance(task)
    _print_loops(checks)
    for joint, bandwidth, check, travel in checks:
        finite = {"margin": check.margin, "unsettled_from": check.unsettled_from}
        finite |= {"unsettled_without": check.unsettled_without}
        found.append(
            {"joint": joint.name, "bandwidth": bandwidth, "source": check.settings.source}
            | {"gain": check.settings.gain, "drift": check.drift, "standstill_travel": travel}
            | {name: value if value != float("inf") else None for name, value in finite.items()}
        )
    return found


def _close_loop(bar: Progress, charts: list[Chart], bandwidths: Any, folder: Path) -> dict[str, Any]:
    from fricomp.cli.loop_charts import close_loop_chart
    from fricomp.sim_bench.studies.tracking.close_loop import close_loop

    task = bar.add_task("close loop", total=None)
    result = close_loop(folder, bandwidths=bandwidths, progress=lambda step: bar.update(task, description=step))
    charts += [close_loop_chart(result, bandwidth) for bandwidth in bandwidths]
    _print_close_loop(result)
    return {
        "true": {name: value for joint in result.settings.joints for name, value in joint.law.parameters().items()},
        "calibrated": result.calibrated.law.parameters(),
        "extended": result.extended.law.parameters(),
        "verdict": result.diagnosis.verdict,
        "named": [effect.name for effect in result.diagnosis.effects],
        "tracking": [
            {"bandwidth": bandwidth, "method": method, "rms": one.rms, "reversal_rms": one.reversal_rms}
            for bandwidth, by_method in result.figures.items()
            for method, one in by_method.items()
        ],
    }


def _print_sines(rows: list[StudyRow]) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    heads = ("none [mrad]", "tanh-Coulomb-viscous", "Stribeck", "default")
    table = Table("joint", "PD", "sine", *heads, title="True error: RMS / RMS within 0.3 s after reversals")
    for row in rows:
        base = row.figures["none"]
        cells = [f"{1e3 * base.rms:.2f} / {1e3 * base.reversal_rms:.2f}"]
        for method in row.figures:
            if method != "none":
                rms, reversal = row.change(method)
                cells.append(f"{rms:+.0%} / {reversal:+.0%}")
        table.add_row(row.joint.title, f"{row.bandwidth:g} Hz", f"{row.amplitude:g} rad", *cells)
    console().print(table)


def _print_robustness(maps: list[RobustnessMap]) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    table = Table("joint", "PD", "wins against tanh-CV", "better than none", title="Robustness: share of combinations")
    for found in maps:
        shares = (f"{found.share_won:.0%}", f"{found.share_helps:.0%}")
        table.add_row(found.joint.title, f"{found.bandwidth:g} Hz", *shares)
    console().print(table)


def _print_loops(checks: list[tuple[TrackedJoint, float, LoopCheck, float]]) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    heads = ("direction from", "margin to the limit cycle", "keeps oscillating when thrown off by", "travel at rest")
    table = Table("joint", "PD", *heads, title="Default loop; thrown off with the drive's limits of 5 N·m, 250 N·m/s")
    for joint, bandwidth, check, travel in checks:
        margin = "none found up to 2.5 times the gain" if check.margin == float("inf") else f"{check.margin:.0%}"
        thrown = "settles" if check.unsettled_from == float("inf") else f"{check.unsettled_from:g} rad"
        also = ", also without" if check.unsettled_without <= check.unsettled_from < float("inf") else ""
        source = check.settings.source
        table.add_row(joint.title, f"{bandwidth:g} Hz", source, margin, thrown + also, f"{travel:.2g} rad")
    console().print(table)


def _print_close_loop(result: CloseLoopResult) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    title = "Closed loop: RMS / RMS within 0.3 s after reversals [mrad]"
    table = Table("PD", "none", "Stribeck, calibrated", "extended by the diagnosis", title=title)
    for bandwidth, figures in result.figures.items():
        cells = []
        for method, one in figures.items():
            rms, reversal = result.change(bandwidth, method)
            change = "" if method == "none" else f" ({rms:+.0%} / {reversal:+.0%})"
            cells.append(f"{1e3 * one.rms:.3f} / {1e3 * one.reversal_rms:.3f}{change}")
        table.add_row(f"{bandwidth:g} Hz", *cells)
    console().print(table)
    for sentence in result.diagnosis.sentences:
        console().print(f"- {sentence}", markup=False)
