"""Charts of loops: gain scan, a run, timing."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fricomp.control.loop.loop_check import LoopCheck
from fricomp.control.loop.loop_log import LoopLog
from fricomp.model import FrictionModel
from fricomp.report import Band, Chart, Line, Panel, ReportPage, Rule, Section, Table


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


def build_run_page(
    models: Sequence[FrictionModel],
    figures: Mapping[str, Mapping[str, Any]],
    charts: Sequence[Chart],
    refused: Sequence[str],
) -> ReportPage:
    """The report of a motion without and with compensation.

    Args:
        models: Of the joints.
        figures: Of the runs `without` and `with`: errors of each joint, cycles, skipped, timing.
        charts: Of the joints, and of the timing last.
        refused: What the system did not grant, in sentences.
    """
    without, compensated = figures["without"], figures["with"]
    sentences, rows = [], []
    for joint, model in enumerate(models):
        before, after = without["rms_error"][joint], compensated["rms_error"][joint]
        change = f"{after / before - 1.0:+.0%}" if before > 0.0 else "–"
        shown, again, largest = (
            f"{1e3 * value:.3g} m{model.position_unit}"
            for value in (before, after, compensated["largest_error"][joint])
        )
        rows.append((model.joint, shown, again, change, largest))
        sentences.append(
            f"Joint {model.joint}: RMS tracking error {shown} without compensation, {again} with it ({change})."
        )
    pairs = zip(compensated["rms_error"], without["rms_error"], strict=True)
    better = all(after < before for after, before in pairs)
    heads = ("joint", "RMS error without", "with compensation", "change", "largest with compensation")
    timing = tuple((name.replace("_", " "), f"{1e6 * value:.1f} µs") for name, value in compensated["timing"].items())
    return ReportPage(
        title=f"Run of {', '.join(model.joint for model in models)}",
        summary=(*sentences, *refused),
        sections=(
            Section("Tracking", (Table(heads, tuple(rows)), *charts[:-1])),
            Section("Timing", (charts[-1], Table(("what, with compensation", "time"), timing))),
        ),
        facts={"cycles": str(compensated["cycles"]), "skipped": str(compensated["skipped"])},
        outcome="passed" if better else "warning",
        verdict="Tracks better with compensation" if better else "Does not track better with compensation",
    )
