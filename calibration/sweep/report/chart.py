"""The charts of a calibration, as plain data."""

from collections.abc import Sequence

import numpy as np

from fricomp.laws import FloatArray
from fricomp.report import Chart, HeatMap, Line, Panel, Points, Rule

from ...identification.report.chart import REACH, training_chart, words
from ..analysis.curve import MEASURED, friction_curve
from ..calibrate import Calibration

__all__ = ["calibration_charts"]


def calibration_charts(calibration: Calibration) -> dict[str, Chart]:
    """All charts by name, in reading order."""
    charts = [
        friction_curve(calibration.analysis, calibration.estimate.result),
        acquisition(calibration),
        residuals(calibration),
        correlations(calibration),
    ]
    traces = calibration.estimate.result.traces
    if traces is not None and len(traces.data_loss) > 1:
        charts.append(training_chart(traces, _get_units(calibration)[1]))
    return {chart.name: chart for chart in charts}


def acquisition(calibration: Calibration) -> Chart:
    """Position, velocity and torque over the whole run."""
    unit, blocks = _get_units(calibration), calibration.data.blocks
    time = _join([samples.time for _, samples in blocks])
    position = _join([samples.position for _, samples in blocks])
    torque = _join([samples.torque for _, samples in blocks])
    reference = _join([np.zeros(len(s)) if s.velocity_reference is None else s.velocity_reference for _, s in blocks])
    panels = (
        Panel((Line(time, position, width=1.0),), "time [s]", f"position [{unit[0]}]", "Position"),
        Panel(
            (Line(time, reference, color=2, width=1.0),), "time [s]", f"velocity [{unit[0]}/s]", "Velocity reference"
        ),
        Panel(
            (Line(time, torque, "torque", color=5, width=0.8), _draw_friction_over_time(calibration)),
            "time [s]",
            f"torque [{unit[1]}]",
            "Torque, and the friction of each plateau",
        ),
    )
    caption = "The whole run: zero of the torque sensor, sign check, warm-up, plateaus in shuffled order, breakaways."
    return Chart("acquisition", "Data acquisition over time", panels, caption=caption, panel_height=210, share_x=True)


def _draw_friction_over_time(calibration: Calibration) -> Points:
    points = calibration.analysis.steady
    return Points(
        np.array([p.time for p in points]), np.array([p.torque for p in points]), "friction", color=MEASURED, size=4.0
    )


def residuals(calibration: Calibration) -> Chart:
    """What the identified curve leaves of the points, over speed and over time."""
    unit, points = _get_units(calibration), calibration.analysis.steady
    model = calibration.estimate.result.model
    left = 1e3 * np.array([p.torque - float(model.torque(p.velocity, normal_load=p.normal_load)) for p in points])
    reach = REACH * 1e3 * float(np.median(calibration.estimate.deviation[: len(points)]))
    forward = np.array([p.velocity > 0.0 for p in points])
    label = f"residual [10⁻³ {unit[1]}]"

    def panel(x: FloatArray, x_label: str, title: str, *, log: bool) -> Panel:
        marks = (
            Rule(reach, "y", "95 % of the scatter"),
            Rule(-reach),
            Points(x[forward], left[forward], "forward", color=0),
            Points(x[~forward], left[~forward], "reverse", color=1),
        )
        return Panel(marks, x_label, label, title, x_scale="log" if log else "linear")

    speed, time = np.array([abs(p.velocity) for p in points]), np.array([p.time for p in points])
    panels = (
        panel(speed, f"speed [{unit[0]}/s]", "Over speed", log=True),
        panel(time, "time [s]", "Over time", log=False),
    )
    caption = "A bow over speed would be friction that the law cannot follow; a slope over time would be drift."
    return Chart("residuals", "Residuals", panels, columns=2, caption=caption)


def correlations(calibration: Calibration) -> Chart:
    """How the errors of the parameters go together."""
    result = calibration.estimate.result
    names = tuple(words(name) for name in result.parameter_names)
    deviation = np.sqrt(np.diag(result.covariance))
    place = np.arange(float(len(names)))
    grid = HeatMap(place, place, result.covariance / np.outer(deviation, deviation), "correlation", True, names, names)
    return Chart("correlation", "Correlation of the parameters", (Panel((grid,), "", ""),), panel_height=420)


def _join(columns: Sequence[FloatArray]) -> FloatArray:
    """Blocks one after the other with a gap between them. Shape (n_samples + n_blocks,)."""
    return np.concatenate([np.append(column, np.nan) for column in columns])


def _get_units(calibration: Calibration) -> tuple[str, str]:
    metadata = calibration.analysis.metadata
    return metadata.position_unit, metadata.torque_unit
