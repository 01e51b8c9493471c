"""The friction curve of a calibration, as a chart: plateaus, what was identified from them, and its band."""

from collections.abc import Sequence

import numpy as np

from fricomp.report import Band, Chart, Line, Mark, Panel, Points, Rule

from ...identification import IdentificationResult
from ...identification.report.chart import REACH
from .analysis import SweepAnalysis
from .point import FrictionPoint

# Positions in the palette: measured, model, network, rejected.
MEASURED, MODEL, NETWORK, REJECTED = 1, 0, 2, 6


def friction_curve(analysis: SweepAnalysis, result: IdentificationResult, *, network: bool = True) -> Chart:
    """Friction over speed, both directions, with points and band.

    Args:
        analysis: The points.
        result: What was identified from them.
        network: Whether the exported network is drawn too.
    """
    panels = tuple(_draw_direction(analysis, result, sign, network=network) for sign in (1, -1))
    return Chart(
        "friction-curve",
        "Friction over speed",
        panels,
        columns=2,
        panel_height=380,
        caption="Each point is the mean of one plateau; the band is the 95 % interval of the identified curve "
        "(where it is thinner than the line, the curve is known better than the eye can see). The torque of the "
        "reverse direction is shown as a positive number.",
    )


def _draw_direction(analysis: SweepAnalysis, result: IdentificationResult, sign: int, *, network: bool) -> Panel:
    points = [p for p in analysis.steady if p.velocity * sign > 0.0]
    rejected = [p for p in analysis.rejected if p.velocity * sign > 0.0]
    speeds = [abs(p.velocity) for p in (*points, *rejected)]
    speed = np.geomspace(0.5 * min(speeds), 1.1 * max(speeds), 300)
    load = analysis.mean_load
    torque = sign * np.asarray(result.model.torque(sign * speed, normal_load=load))
    reach = REACH * result.torque_deviation(sign * speed, None if load is None else np.full_like(speed, load))
    marks: list[Mark] = [
        Band(speed, torque - reach, torque + reach, "95 % interval", color=MODEL),
        Line(speed, torque, "identified", color=MODEL),
    ]
    if network:
        followed = sign * np.asarray(result.network.torque(sign * speed, load))
        marks.append(Line(speed, followed, "exported network", color=NETWORK, stroke="dashed", width=1.2))
    marks.append(_draw_points(points, sign, "plateaus", MEASURED))
    if rejected:
        marks.append(_draw_points(rejected, sign, "rejected", REJECTED, hollow=True))
    static = analysis.static_torque(sign)
    if static is not None:
        marks.append(Rule(static.value, "y", "breakaway", color=3))
    title = "Forward" if sign > 0 else "Reverse"
    unit = analysis.metadata
    labels = f"speed [{unit.position_unit}/s]", f"friction [{unit.torque_unit}]"
    return Panel(tuple(marks), *labels, title, x_scale="log")


def _draw_points(points: Sequence[FrictionPoint], sign: int, label: str, color: int, *, hollow: bool = False) -> Points:
    return Points(
        np.array([abs(p.velocity) for p in points]),
        np.array([sign * p.torque for p in points]),
        label,
        color=color,
        hollow=hollow,
    )
