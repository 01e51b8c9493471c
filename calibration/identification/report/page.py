"""The report of an identification: curve, residuals, parameters, training, and what to make of it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.overview import AT_BOUND
from fricomp.recording.parts.data_chart import build_data_table, draw_data_chart
from fricomp.recording.parts.parts import UsableParts
from fricomp.report import (
    Chart,
    Check,
    Outcome,
    Panel,
    Points,
    ReportPage,
    Section,
    Table,
    draw_png,
    write_report,
)

from ..curve import friction_curve
from ..estimation.observation import Observations
from ..result import IdentificationResult
from ..status import Status
from .chart import network_note, training_chart, words

_SEES_STATIC = 0.5
"""Slowest speed over Stribeck velocity up to which points show the static torque: exp(-1/4) = 78 % of what it adds."""

_MOST_SHOWN = 4000
"""Points of a chart: more lie on each other, and would make the page larger than the data."""


def write_identification_report(
    result: IdentificationResult,
    folder: Path,
    notes: Sequence[str],
    facts: dict[str, str] | None,
    data: UsableParts | None,
) -> Path:
    """Write `report.html` and a PNG of each chart into `folder`.

    Args:
        result: What was identified.
        folder: Where to write.
        notes: Further sentences for the summary.
        facts: Further lines on how it was made.
        data: What was used of the recording; None for a table.
    """
    charts = identification_charts(result)
    of_data = () if data is None else (draw_data_chart(data, "data", "What was used of the recording"),)
    for chart in (*charts, *of_data):
        draw_png(chart, folder / f"{chart.name}.png")
    sections = (
        Section("Friction curve", (charts[0],)),
        Section("Parameters", (_tabulate(result),)),
        Section("What was checked", _list_checks(result)),
        Section("Residuals", (charts[1],)),
        *((Section("Training", (charts[2], network_note(result))),) if len(charts) > 2 else ()),
        *((Section("The data", (build_data_table(data), *of_data)),) if data is not None else ()),
        Section("How it was made", (Table(("what", "value"), tuple((facts or {}).items())),), folded=True),
    )
    page = ReportPage(
        title=f"Friction of joint {result.model.joint}",
        summary=(f"{result.message[0].upper()}{result.message[1:]}.", *notes),
        sections=sections,
        facts={"points": str(result.observations.size), "method": result.method, "noise": result.noise.kind},
        outcome=judge_status(result.status)[0],
        verdict=judge_status(result.status)[1],
    )
    return write_report(page, folder / "report.html")


def judge_status(status: Status) -> tuple[Outcome, str]:
    """What the first card of a report says of a status: whether the model may be used, in a word or two."""
    if find_doubt_in_status(status, "") is not None:
        return "failed", "Not usable"
    return ("passed", "Usable") if status is Status.CONVERGED else ("warning", "Usable with care")


def _tabulate(result: IdentificationResult) -> Table:
    """The parameters; the column of the profile is left out where no parameter has one."""
    interval = "95 % interval, if the law held" if result.status is Status.LACK_OF_FIT else "95 % interval"
    heads = ("parameter", "value", interval, "by profile likelihood", "unit")
    rows = [(words(name), *rest) for name, *rest in parameter_rows(result)]
    if any(row[3] for row in rows):
        return Table(heads, tuple(rows))
    return Table((*heads[:3], heads[4]), tuple((*row[:3], row[4]) for row in rows))


def parameter_rows(result: IdentificationResult) -> tuple[tuple[str, ...], ...]:
    """Name, value, interval from the covariance, interval from the profile where it differs in kind, unit."""
    units, rows = result.model.units(), []
    for name in result.parameter_names:
        plain = result.interval(name)
        profile = _format_between(*vars(result.profiles[name]).values()) if name in result.profiles else ""
        value, ends = f"{result.parameters[name]:.5g}", _format_between(plain.lower, plain.upper)
        if name in result.at_bound:  # what has shrunk to nothing is not printed as 1e-12
            value, ends, profile = f"{round(result.parameters[name], 9):.5g}", f"{ends}, {AT_BOUND}", ""
        rows.append((name, value, ends, profile, units[name]))
    return tuple(rows)


def _format_between(lower: float, upper: float) -> str:
    if np.isfinite(upper - lower):
        return f"{lower:.5g} to {upper:.5g}"
    return f"at least {lower:.5g}" if lower > 0.0 else "cannot be determined"


def identification_charts(result: IdentificationResult) -> list[Chart]:
    """Friction curve, residuals and, where a network was trained, its course; of many points an even selection."""
    curve = friction_curve(result.model, _select_shown(result.observations), result.torque_deviation, result.network)
    charts = [curve, _draw_residuals(result)]
    return charts if result.traces is None else [*charts, training_chart(result.traces, result.model.torque_unit)]


def _draw_residuals(result: IdentificationResult) -> Chart:
    units, points = _get_units(result), _select_shown(result.observations)
    magnitude, _ = result.form.evaluate(result.optimum.logs, points)
    deviation = result.noise.level * (magnitude if result.noise.kind == "relative" else 1.0)
    scaled = (points.magnitude - magnitude) / deviation
    if result.noise.kind == "given":
        scaled = result.at_points.whitened.residual[_choose_shown(result.observations)]
    mark = Points(points.velocity, scaled, "residual", size=3.0)
    panel = Panel((mark,), f"velocity [{units[0]}]", "residual [standard deviations]")
    return Chart("residuals", "Residuals", (panel,), caption="No trend should be left in them.")


def _select_shown(points: Observations) -> Observations:
    """The points that a chart shows: all, or of many as many as it can show."""
    return points.select(np.arange(points.size)[_choose_shown(points)])


def _choose_shown(points: Observations) -> slice:
    """Every point, or every so manieth of many."""
    return slice(None, None, -(-points.size // _MOST_SHOWN))


def _list_checks(result: IdentificationResult) -> tuple[Check, ...]:
    status, _ = judge_status(result.status)
    choice = f"{result.noise.kind} noise, level {result.noise.level:.4g}"
    if np.isfinite(result.noise.evidence):  # none where its kind was known
        choice += f"; the next best noise model is less likely by {result.noise.evidence:.2g} nats"
    error = result.distillation.largest_error
    exported = f"the exported network is within {error:.2g} of the largest torque of the closed form"
    return (
        Check("Status", status, result.message),
        *_check_slowest_speed(result),
        Check(
            "Likelihood optimum",
            "passed" if result.distance_to_optimum < 0.1 else "warning",
            f"{result.distance_to_optimum:.2g} standard deviations from what projection and least squares find",
        ),
        Check("Noise", "note", choice),
        Check("Network", "passed" if result.distillation.largest_error < 0.01 else "warning", exported),
    )


def _check_slowest_speed(result: IdentificationResult) -> tuple[Check, ...]:
    """Whether the static torque was seen, or extrapolated from the bend above it."""
    bends = [value for name, value in result.parameters.items() if name.endswith("stribeck_velocity")]
    if not bends:
        return ()
    slowest, unit = float(result.observations.speed.min()), _get_units(result)[0]
    far = slowest > _SEES_STATIC * min(bends)
    said = f"{slowest:.3g} {unit}, with the Stribeck velocity at {min(bends):.3g} {unit}"
    more = f": the static torque is extrapolated; measure below {_SEES_STATIC * min(bends):.2g} {unit}" if far else ""
    return (Check("Slowest speed", "warning" if far else "passed", said + more),)


def _get_units(result: IdentificationResult) -> tuple[str, str]:
    return f"{result.model.position_unit}/s", result.model.torque_unit
