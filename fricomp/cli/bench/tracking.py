"""`fricomp bench tracking`: what compensation is worth, and where it loses."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from fricomp.control import LoopCheck
    from fricomp.sim_bench.tracking import RobustnessMap, StudyRow, TrackedJoint

__all__ = ["app"]

app = typer.Typer()

_QUICK_AXES: dict[str, Any] = {"gain": (0.6, 1.0, 1.3), "scale": (0.7, 1.0, 1.3), "delay": (0.001, 0.008)}


@app.command(epilog="fricomp bench tracking --quick --out runs/tracking")
def tracking(
    out: Annotated[Path, typer.Option(help="Folder for figures.json and the plots.")] = Path("runs/bench_tracking"),
    quick: Annotated[bool, typer.Option(help="One amplitude and bandwidth, a coarse map.")] = False,
) -> None:
    """Sines on the stand-in with none, tanh-Coulomb-viscous, Stribeck and the default; and the robustness map."""
    import msgspec

    from fricomp.cli.loop_charts import gain_scan_chart, robustness_chart, tracking_charts
    from fricomp.cli.terminal import console, progress
    from fricomp.report import draw_png
    from fricomp.sim_bench.tracking import JOINTS, compute_robustness, run_study

    out.mkdir(parents=True, exist_ok=True)
    amplitudes, bandwidths = ((0.2,), (5.0,)) if quick else ((0.2, 0.5), (5.0, 10.0))
    with progress() as bar:
        task = bar.add_task("tracking", total=len(JOINTS) * len(amplitudes) * len(bandwidths))
        rows = []
        for row in run_study(tuple(JOINTS.values()), amplitudes, bandwidths):
            rows.append(row)
            bar.advance(task)
        task = bar.add_task("robustness", total=len(JOINTS) * len(bandwidths))
        maps = []
        for joint in JOINTS.values():
            for bandwidth in bandwidths:
                maps.append(compute_robustness(joint, bandwidth, **(_QUICK_AXES if quick else {})))
                bar.advance(task)
    checks = [(joint, bandwidth, _check(joint, bandwidth)) for joint in JOINTS.values() for bandwidth in bandwidths]
    charts = [*tracking_charts(rows), *(robustness_chart(found) for found in maps)]
    charts += [gain_scan_chart(check, f"{joint.title}, {bandwidth:g} Hz") for joint, bandwidth, check in checks]
    for number, chart in enumerate(charts):
        draw_png(chart, out / f"{number:02d}-{chart.name}.png")
    figures = _figures(rows, maps, checks)
    (out / "figures.json").write_bytes(msgspec.json.format(msgspec.json.encode(figures)))
    _print(rows, maps, checks)
    console().print(f"Figures and {len(charts)} plots in {out}")


def _check(joint: TrackedJoint, bandwidth: float) -> LoopCheck:
    from fricomp.control import check_loop
    from fricomp.sim_bench.stand_in import SensorSettings
    from fricomp.sim_bench.tracking.joint import loop_of

    _, loop = loop_of(bandwidth, SensorSettings(), 1e-3)
    return check_loop(joint.model, loop)


def _figures(
    rows: list[StudyRow], maps: list[RobustnessMap], checks: list[tuple[TrackedJoint, float, LoopCheck]]
) -> dict[str, Any]:
    from fricomp.sim_bench.tracking import TrackingCase, run_standstill

    tracking = [
        {
            "joint": row.joint.name,
            "amplitude": row.amplitude,
            "bandwidth": row.bandwidth,
            "rms": {method: found.rms for method, found in row.figures.items()},
            "reversal_rms": {method: found.reversal_rms for method, found in row.figures.items()},
        }
        for row in rows
    ]
    robustness = [
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
    loops = [
        {
            "joint": joint.name,
            "bandwidth": bandwidth,
            "source": check.settings.source,
            "gain": check.settings.gain,
            "margin": check.margin if check.margin != float("inf") else None,
            "drift": check.drift,
            "standstill_travel": run_standstill(TrackingCase(joint, "default", 0.2, bandwidth)),
        }
        for joint, bandwidth, check in checks
    ]
    return {"tracking": tracking, "robustness": robustness, "loops": loops}


def _print(
    rows: list[StudyRow], maps: list[RobustnessMap], checks: list[tuple[TrackedJoint, float, LoopCheck]]
) -> None:
    from rich.table import Table

    from fricomp.cli.terminal import console

    out = console()
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
    out.print(table)
    table = Table("joint", "PD", "wins against tanh-CV", "better than none", title="Robustness: share of combinations")
    for found in maps:
        shares = (f"{found.share_won:.0%}", f"{found.share_helps:.0%}")
        table.add_row(found.joint.title, f"{found.bandwidth:g} Hz", *shares)
    out.print(table)
    table = Table("joint", "PD", "direction from", "margin to the limit cycle", "drift", title="Default loop")
    for joint, bandwidth, check in checks:
        margin = "none found up to 2.5 times the gain" if check.margin == float("inf") else f"{check.margin:.0%}"
        table.add_row(joint.title, f"{bandwidth:g} Hz", check.settings.source, margin, f"{check.drift:.2g} rad")
    out.print(table)
