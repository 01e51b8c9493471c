"""Before and after over time, and the motion that is proposed next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.laws import FloatArray
from fricomp.report import Band, Chart, Line, Mark, Panel, Rule

from ..record.result import DiagnosisRecord, FileSeries, RowSeries
from .settings import REPORT
from .wording import Units, describe_name

BEFORE, AFTER, NOISE = 1, 0, 6
"""Colours of the base model, of the extended model and of the noise, in every chart."""

BASE, NAMED = "base model", "with what was named"
"""Names of the base model and of the extended one, in every chart."""

AS_GIVEN = "named parameters as given, the rest refitted"
"""Name of the base model before, where only parameters are off."""


def name_models(record: DiagnosisRecord) -> tuple[str, ...]:
    """Names of what the rows before and after belong to; of one where nothing was named."""
    if record.heldout is not None and record.heldout.before == "given":
        return (AS_GIVEN, "everything refitted")
    return (BASE, NAMED) if record.effects else (BASE,)


def draw_error_chart(files: Sequence[FileSeries], units: Units, models: tuple[str, ...]) -> Chart | None:
    """What the written models leave of the torque; None where none was written.

    Args:
        files: Of each part of the recordings.
        units: Of the diagnosis.
        models: Names of what is drawn: before, and after where there is one.
    """
    shown = files[: REPORT.recordings]
    if not shown:
        return None
    panels = tuple(_draw_errors(one, units, models) for one in shown)
    caption = (
        f"Recorded torque less that of the model, in the band from 0 to {shown[0].band:g} Hz, while the joint moves: "
        "what friction.json leaves, as fricomp evaluate measures it, and what the base model leaves."
    )
    return Chart("torque-error", "Torque error of the files", panels, caption=caption, panel_height=230)


def _draw_errors(one: FileSeries, units: Units, models: tuple[str, ...]) -> Panel:
    sides = ((one.before, BEFORE), (one.after, AFTER))
    marks = tuple(
        Line(one.time, rows, name, color=color, width=1.0) for name, (rows, color) in zip(models, sides, strict=False)
    )
    reach = _find_range([rows for rows, _ in sides[: len(models)]], np.zeros(1))
    return Panel(marks, "time [s]", f"torque error [{units.torque}]", one.name, y_range=reach)


def draw_time_chart(
    series: RowSeries, units: Units, number: int, models: tuple[str, ...], changes: tuple[float, ...] = ()
) -> Chart:
    """Missing torque before and after, over the motion.

    Args:
        series: Rows of one recording.
        units: Of the diagnosis.
        number: Of the recording, for the chart's name.
        models: Names of what is drawn: before, and after where there is one.
        changes: Times at which the size of the residual changes [s].
    """
    noise = 1.96 * series.spread
    time, before, after, velocity, position = _break_at_gaps(
        series.time, series.before, series.after, series.velocity, series.position
    )
    marks: list[Mark] = [Band(series.time, -noise, noise, "noise (95 %)", color=NOISE)]
    sides = ((before, BEFORE), (after, AFTER))
    marks += [
        Line(time, rows, name, color=color, width=1.0) for name, (rows, color) in zip(models, sides, strict=False)
    ]
    marks += [Rule(time, "x", "its size changes" if i == 0 else "", color=4) for i, time in enumerate(changes)]
    residual = Panel(
        tuple(marks),
        "time [s]",
        f"missing torque [{units.torque}]",
        "Measured less simulated torque",
        y_range=_find_range([rows for rows, _ in sides[: len(models)]], noise),
    )
    motion = Panel((Line(time, velocity, color=2, width=1.0),), "time [s]", units.label_axis("velocity"), "Motion")
    place = Panel((Line(time, position, color=3, width=1.0),), "time [s]", units.label_axis("position"))
    return Chart(
        f"over-time-{number}",
        f"Residual of the fit over time: {series.name}",
        (residual, motion, place),
        caption="Drag a box to look closer; all panels follow. Values are means over windows, on which the "
        "verdict rests. The "
        "grey band is wide where the joint has just turned round, and cut off there: no recording fixes friction at a "
        "reversal to the last digit.",
        panel_height=230,
        share_x=True,
    )


def _break_at_gaps(time: FloatArray, *columns: FloatArray) -> tuple[FloatArray, ...]:
    """Times and columns with a value of none in each gap between rows: a line across it would be no data."""
    steps = np.diff(time)
    after = np.flatnonzero(steps > REPORT.gap * np.median(steps)) + 1 if steps.size else np.zeros(0, dtype=np.intp)
    return np.insert(time, after, time[after - 1]), *(np.insert(one, after, np.nan) for one in columns)


def _find_range(rows: Sequence[FloatArray], noise: FloatArray) -> tuple[float, float]:
    """What shows all rows and the usual noise; its few wide places would leave the rows a flat line."""
    known = noise[np.isfinite(noise)]
    usual = np.median(known, keepdims=True) if known.size else np.zeros(1)
    largest = max(float(np.nanmax(np.abs(each), initial=0.0)) for each in (*rows, usual))
    reach = 1.1 * largest if largest > 0.0 else 1.0
    return -reach, reach


def draw_motion_chart(motion: Mapping[str, FloatArray], units: Units) -> Chart:
    """The motion to record next."""
    columns = list_motion_columns(motion)
    panels = tuple(
        Panel(
            (Line(columns["time"], columns[name], color=2, width=1.2),),
            "time [s]",
            units.label_axis(name),
            describe_name(name).capitalize(),
        )
        for name in ("velocity", "position")
        if name in columns
    )
    caption = "The columns of motion.csv."
    return Chart("motion", "Motion to record next", panels, caption=caption, panel_height=200, share_x=True)


def list_motion_columns(motion: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Columns as a motion file names them: time first, then velocity and position."""
    plain = {name.removesuffix("_reference"): np.asarray(values) for name, values in motion.items()}
    return {name: plain[name] for name in ("time", "velocity", "position") if name in plain}
