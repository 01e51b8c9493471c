"""Charts of loops: gain scan, a run, timing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fricomp.control.loop.loop_check import LoopCheck
from fricomp.control.loop.loop_log import LoopLog
from fricomp.report import Band, Chart, Line, Panel, Rule

__all__ = ["gain_scan_chart", "histogram_panel", "run_chart", "timing_chart"]


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
