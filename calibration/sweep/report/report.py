"""The report of a calibration: one page, and its charts as pictures."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.overview import AT_BOUND
from fricomp.report import Chart, Check, ReportPage, Section, Table, draw_png, write_report

from ...identification.report.chart import REACH, network_note, words
from ...identification.report.page import judge_status
from ..calibrate import Calibration, mean_relative_deviation
from .chart import calibration_charts


def write_calibration_report(
    calibration: Calibration, checks: tuple[Check, ...], facts: Mapping[str, str], folder: Path
) -> tuple[Path, tuple[Path, ...]]:
    """Write `report.html` and a PNG of every chart.

    Args:
        calibration: What was found.
        checks: What was checked.
        facts: Further lines for the section on how the run was made.
        folder: Of the run.

    Returns:
        The page and the pictures.
    """
    charts = calibration_charts(calibration)
    page = write_report(calibration_page(calibration, charts, checks, facts), folder / "report.html")
    return page, tuple(draw_png(chart, folder / f"{name}.png") for name, chart in charts.items())


def parameter_table(calibration: Calibration) -> Table:
    """Value, unit, 95 % interval and relative standard deviation of every parameter."""
    result = calibration.estimate.result
    units, rows = result.model.units(), []
    for name in result.parameter_names:
        interval, value = result.interval(name), result.parameters[name]
        at_bound = name in result.at_bound
        digits = _count_digits(value, interval.upper - interval.lower)
        rows.append(
            (
                words(name),
                f"{value:.{digits}f}",
                f"{interval.lower:.{digits}f} to {interval.upper:.{digits}f}{f', {AT_BOUND}' if at_bound else ''}",
                units[name],
                "–" if at_bound else f"{result.standard_deviations[name] / value:.2%}",
            )
        )
    return Table(("parameter", "value", "95 % interval", "unit", "standard deviation"), tuple(rows))


def _count_digits(value: float, width: float) -> int:
    """Decimals that show the interval's width with two figures."""
    size = width if width > 0.0 else abs(value) * 1e-6
    return int(np.clip(1 - np.floor(np.log10(max(size, 1e-12))), 0, 9))


def calibration_page(
    calibration: Calibration, charts: Mapping[str, Chart], checks: tuple[Check, ...], facts: Mapping[str, str]
) -> ReportPage:
    """The page: what was found, the curve, parameters, checks, data, and how it was made."""
    analysis, result = calibration.analysis, calibration.estimate.result
    sections = [
        Section("Friction curve", (charts["friction-curve"],)),
        Section("Parameters", (parameter_table(calibration), _describe_parameters(calibration), charts["correlation"])),
        Section("What was checked", checks),
        Section("Data", (charts["acquisition"], _describe_source(calibration))),
        Section("Residuals", (charts["residuals"],)),
        Section("Network", (*((charts["training"],) if "training" in charts else ()), network_note(result))),
        Section("Plateaus", (_make_plateau_table(calibration),), folded=True),
        Section("How it was made", (Table(("what", "value"), tuple(facts.items())),), folded=True),
    ]
    return ReportPage(
        title=f"Friction of joint {analysis.metadata.joint}",
        subtitle=f"Calibrated {result.model.provenance.created} with fricomp {result.model.provenance.fricomp_version}",
        summary=_write_summary(calibration, checks),
        sections=tuple(sections),
        facts={
            "plateaus used": f"{len(analysis.steady)} of {len(analysis.points)}",
            "speeds": _format_speed_range(calibration),
            "duration": f"{calibration.data.blocks[-1][1].time[-1]:.0f} s",
            "mean standard deviation": f"{mean_relative_deviation(calibration.estimate):.2%}",
            "method": f"{result.method}, {result.status}",
        },
        outcome=judge_status(result.status)[0],
        verdict=judge_status(result.status)[1],
    )


def _format_speed_range(calibration: Calibration) -> str:
    speeds = [abs(p.velocity) for p in calibration.analysis.points]
    return f"{min(speeds):.3g} to {max(speeds):.3g} {calibration.analysis.metadata.position_unit}/s"


def _write_summary(calibration: Calibration, checks: tuple[Check, ...]) -> tuple[str, ...]:
    model, analysis = calibration.estimate.result.model, calibration.analysis
    unit = analysis.metadata.torque_unit
    bad = [check.name.lower() for check in checks if check.outcome in ("warning", "failed")]
    verdict = (
        "Every check passed: friction.json and friction.onnx can be used."
        if not bad
        else f"Look at this before you use the model: {', '.join(bad)}."
    )
    return (_describe_curve(calibration, unit), verdict, *_describe_asymmetry(model.forward, model.reverse, unit))


def _describe_curve(calibration: Calibration, unit: str) -> str:
    model, metadata = calibration.estimate.result.model, calibration.analysis.metadata
    forward, reverse = model.forward, model.reverse
    return (
        f"The joint gives way at {forward.static_torque:.3g} {unit} forward and {reverse.static_torque:.3g} {unit} in "
        f"reverse, slides at {forward.coulomb_torque:.3g} and {reverse.coulomb_torque:.3g} {unit} of dry friction, and "
        f"falls from one to the other at about {forward.stribeck_velocity:.3g} {metadata.position_unit}/s."
    )


def _describe_asymmetry(forward: object, reverse: object, unit: str) -> tuple[str, ...]:
    a, b = getattr(forward, "coulomb_torque", 0.0), getattr(reverse, "coulomb_torque", 0.0)
    if max(a, b) == 0.0 or abs(a - b) < 0.05 * max(a, b):
        return ()
    more = "reverse" if b > a else "forward"
    return (f"Friction is not the same in both directions: {abs(b - a):.2g} {unit} more dry friction in {more}.",)


def _describe_parameters(calibration: Calibration) -> str:
    offset = calibration.analysis.offset
    return (
        "Intervals hold the scatter of the plateaus, estimated from itself, and what is not known of the zero of the "
        f"torque sensor (± {REACH * offset.deviation:.1g} {calibration.analysis.metadata.torque_unit}), which all "
        "plateaus share. They do not hold an error of scale: a torque constant that is 1 % off makes every torque 1 % "
        "off."
    )


def _describe_source(calibration: Calibration) -> str:
    analysis = calibration.analysis
    at = "" if analysis.mean_load is None else f"; the parameters hold at {analysis.mean_load:.4g}, its mean"
    return (
        f"The drive's torque is {analysis.metadata.torque_kind}. Friction is the {analysis.torque_source}. "
        f"Normal load: {analysis.load_source}{at}."
    )


def _make_plateau_table(calibration: Calibration) -> Table:
    analysis = calibration.analysis
    unit = analysis.metadata
    rows = tuple(
        (
            str(p.number),
            f"{p.time:.1f}",
            f"{p.velocity:+.5g}",
            f"{p.torque:+.5g}",
            f"{p.deviation:.2g}",
            f"{p.duration:.2f}",
            p.verdict.replace("_", " "),
        )
        for p in analysis.points
    )
    heads = ("plateau", "time [s]", f"velocity [{unit.position_unit}/s]", f"friction [{unit.torque_unit}]")
    return Table((*heads, f"scatter inside [{unit.torque_unit}]", "settled for [s]", "verdict"), rows)
