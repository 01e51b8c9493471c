"""Charts of loops: gain scan, tracking, robustness, timing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fricomp.control import LoopLog
from fricomp.control.loop.loop_check import LoopCheck
from fricomp.report import Band, Bars, Chart, HeatMap, Line, Panel, Rule

if TYPE_CHECKING:
    from fricomp.sim_bench.studies.latency.compensator import Cost
    from fricomp.sim_bench.studies.tracking import RobustnessMap, StudyRow
    from fricomp.sim_bench.studies.tracking.close_loop import CloseLoopMethod, CloseLoopResult

__all__ = [
    "close_loop_chart",
    "cost_chart",
    "gain_scan_chart",
    "histogram_panel",
    "robustness_chart",
    "run_chart",
    "timing_chart",
    "tracking_charts",
]

_NAMES = {"none": "none", "coulomb_viscous": "tanh-Coulomb-viscous", "stribeck": "Stribeck", "default": "default"}


_CLOSE_LOOP_NAMES = {"none": "none", "stribeck": "Stribeck, calibrated", "extended": "extended by the diagnosis"}


def gain_scan_chart(check: LoopCheck, joint: str) -> Chart:
    """Swing of the simulated velocity over the gain, and where either finding oscillates."""
    scan = check.scan
    swing = np.minimum(scan.swing, 10.0)
    marks = (
        Band(scan.gain, np.zeros_like(swing), 10.0 * scan.predicted, "oscillates, predicted"),
        Line(scan.gain, np.maximum(swing, 1e-3), "largest swing, simulated"),
        Rule(0.5, label="counts as oscillating"),
        Rule(check.settings.gain, "x", "gain in use", 1),
    )
    panel = Panel(marks, "gain of the compensation [1]", "swing over reference velocity [1]", y_scale="log")
    caption = "Swing of the velocity around its steady reference, worst over speeds of both directions."
    return Chart("gain-scan", f"Where the loop of {joint} oscillates", (panel,), caption=caption)


def tracking_charts(rows: Sequence[StudyRow]) -> list[Chart]:
    """For each condition the error over time, and bars of all figures."""
    charts = []
    for row in rows:
        panels = []
        for method, figures in row.figures.items():
            if method == "none":
                continue
            base = row.figures["none"]
            marks = (
                Line(base.time, 1e3 * base.error, "none", 6, width=1.0),
                Line(figures.time, 1e3 * figures.error, _NAMES[method], 0, width=1.0),
            )
            rms, reversal = row.change(method)
            title = f"{_NAMES[method]}: RMS {rms:+.0%}, reversals {reversal:+.0%}"
            panels.append(Panel(marks, "time [s]", "error [mrad]", title))
        name = f"tracking-{row.joint.name}-{row.bandwidth:g}hz-{row.amplitude:g}rad"
        title = f"{row.joint.title}, {row.bandwidth:g} Hz, {row.amplitude:g} rad"
        charts.append(Chart(name, title, tuple(panels), share_x=True, panel_height=220))
    return [_bars(rows), *charts]


def _bars(rows: Sequence[StudyRow]) -> Chart:
    names = tuple(f"{row.joint.name} {row.bandwidth:g} Hz {row.amplitude:g} rad" for row in rows)
    panels = []
    for index, title in enumerate(("whole motion", "0.3 s after reversals")):
        marks = tuple(
            Bars(names, np.array([100.0 * (1.0 + row.change(method)[index]) for row in rows]), _NAMES[method])
            for method in rows[0].figures
            if method != "none"
        )
        panels.append(Panel(marks, "", "RMS error, % of that without", title))
    caption = "Lower is better. True error of the stand-in joint, which sticks."
    return Chart("tracking", "Tracking with friction compensation", tuple(panels), caption=caption)


def robustness_chart(found: RobustnessMap) -> Chart:
    """Maps over gain and friction, and over gain and delay: our RMS against none, and against the rival."""
    middle_delay = int(np.argmin(np.abs(found.delay - 0.001)))
    middle_scale = int(np.argmin(np.abs(found.scale - 1.0)))
    panels = []
    for title, ours, rival in (
        ("whole motion", found.ours, found.rival),
        ("reversals", found.ours_reversal, found.rival_reversal),
    ):
        for against, ratio in (("none", ours), ("tanh-Coulomb-viscous", (1.0 + ours) / (1.0 + rival) - 1.0)):
            shown = np.clip(100.0 * ratio, -100.0, 100.0)
            over_scale, over_delay = shown[:, :, middle_delay].T, shown[:, middle_scale, :].T
            head = f"{title}, against {against}"
            for y_label, y, values in (
                ("true over modelled friction [1]", found.scale, over_scale),
                ("delay [ms]", 1e3 * found.delay, over_delay),
            ):
                heat = HeatMap(found.gain, y, values, "change of RMS [%]", diverging=True)
                panels.append(Panel((heat,), "gain [1]", y_label, head))
    caption = (
        f"Negative is better. The default wins against tanh-Coulomb-viscous in {found.share_won:.0%} and helps in "
        f"{found.share_helps:.0%} of all {found.ours.size} combinations; settings are those for a delay of 1 ms."
    )
    name = f"robustness-{found.joint.name}-{found.bandwidth:g}hz"
    return Chart(name, f"Robustness, {found.joint.title}, {found.bandwidth:g} Hz", tuple(panels), 2, caption)


def timing_chart(log: LoopLog, period: float) -> Chart:
    """Histograms of lateness and of the time a cycle takes."""
    panels = (
        histogram_panel(1e6 * log.lateness, "lateness of a cycle's start [µs]"),
        histogram_panel(1e6 * log.busy, "time a cycle took [µs]"),
    )
    return Chart("timing", f"Timing of the loop at {1.0 / period:.0f} Hz", panels, 2)


def histogram_panel(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]], label: str) -> Panel:
    """Counts over `values`, both on logarithmic scales."""
    shown = np.maximum(values, 1e-2)
    # Whole decades: on less than two the labels of the axis would overlap.
    low, high = np.floor(np.log10(shown.min())), np.ceil(np.log10(shown.max()))
    edges = np.logspace(low, max(high, low + 2.0), 60)
    counts, _ = np.histogram(shown, edges)
    curve = Line(np.repeat(edges, 2)[1:-1], np.repeat(np.maximum(counts, 0.5), 2))
    return Panel((curve,), label, "cycles", x_scale="log", y_scale="log")


def run_chart(logs: Mapping[str, LoopLog], joint: int, units: tuple[str, str]) -> Chart:
    """Reference and position, error and torque of one joint, for each run."""
    position_unit, torque_unit = units
    positions, errors, torques = [], [], []
    for number, (name, log) in enumerate(logs.items()):
        time = log.time
        reference, position = log.signal("position_reference")[:, joint], log.signal("position")[:, joint]
        if not number:
            positions.append(Line(time, reference, "reference", 6, "dashed"))
        positions.append(Line(time, position, name, number))
        errors.append(Line(time, 1e3 * (reference - position), name, number, width=1.0))
        torques.append(Line(time, log.signal("torque_command")[:, joint], name, number, width=1.0))
    panels = (
        Panel(tuple(positions), "time [s]", f"position [{position_unit}]"),
        Panel(tuple(errors), "time [s]", f"error [m{position_unit}]"),
        Panel(tuple(torques), "time [s]", f"torque [{torque_unit}]"),
    )
    return Chart(f"run-{joint}", "A reference motion with and without compensation", panels, share_x=True)


def close_loop_chart(result: CloseLoopResult, bandwidth: float) -> Chart:
    """Error over time without compensation, with the calibrated model, and with the extended one."""
    figures = result.figures[bandwidth]
    base = figures["none"]
    panels = []
    compensated: tuple[CloseLoopMethod, ...] = ("stribeck", "extended")
    for number, method in enumerate(compensated):
        found = figures[method]
        marks = (
            Line(base.time, 1e3 * base.error, "none", 6, width=1.0),
            Line(found.time, 1e3 * found.error, _CLOSE_LOOP_NAMES[method], number, width=1.0),
        )
        rms, reversal = result.change(bandwidth, method)
        title = f"{_CLOSE_LOOP_NAMES[method]}: RMS {rms:+.0%}, reversals {reversal:+.0%}"
        panels.append(Panel(marks, "time [s]", "error [mrad]", title))
    both = tuple(
        Line(figures[method].time, 1e3 * figures[method].error, _CLOSE_LOOP_NAMES[method], number, width=1.0)
        for number, method in enumerate(compensated)
    )
    panels.append(Panel(both, "time [s]", "error [mrad]", "both compensations on their own scale"))
    named = ", ".join(effect.name for effect in result.diagnosis.effects if effect.kind == "physics")
    caption = f"Sine of 0.5 rad at 0.1 Hz on a joint with concealed effects; the diagnosis named {named}."
    title = f"Calibrate, compensate, diagnose, compensate again: PD {bandwidth:g} Hz"
    return Chart(f"close-loop-{bandwidth:g}hz", title, tuple(panels), share_x=True, panel_height=240, caption=caption)


def cost_chart(costs: Sequence[Cost]) -> Chart:
    """Cost of each call in units of a bare Stribeck curve, beside its limit."""
    names = tuple(cost.name for cost in costs)
    marks = (
        Bars(names, np.array([cost.units for cost in costs]), "measured"),
        Bars(names, np.array([cost.limit if cost.limit is not None else np.nan for cost in costs]), "at most"),
    )
    return Chart("costs", "Cost of a call", (Panel(marks, "", "× bare Stribeck in math", y_scale="log"),))
