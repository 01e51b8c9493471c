"""The picture of an identification: measured points, the curve with its band, and the exported network."""

from collections.abc import Callable

import numpy as np

from fricomp.laws import FloatArray
from fricomp.model import FrictionModel
from fricomp.report import Band, Chart, Line, Mark, Panel, Points

from ..network import TanhNetwork
from .estimation.observation import Observations

__all__ = ["REACH", "friction_curve"]

REACH = 1.96
"""Half width of a 95 % interval in standard deviations."""

Deviation = Callable[[FloatArray, FloatArray | None], FloatArray]


def friction_curve(
    model: FrictionModel, points: Observations, deviation: Deviation, network: TanhNetwork | None = None
) -> Chart:
    """Friction over speed, one panel a direction.

    Args:
        model: What was identified.
        points: What it was identified from.
        deviation: Standard deviation of its torque at velocities and loads [N·m] or [N].
        network: The exported network; None to leave it out.
    """
    panels = []
    for name, sign in (("forward", 1.0), ("reverse", -1.0)):
        rows = points.forward if sign > 0.0 else ~points.forward
        if not np.any(rows):
            continue
        load = None if points.normal_load is None else float(np.median(points.normal_load[rows]))
        speed = np.geomspace(points.speed[rows].min(), points.speed[rows].max(), 300)
        loads = None if load is None else np.full_like(speed, load)
        torque = sign * np.asarray(model.torque(sign * speed, normal_load=load))
        reach = REACH * deviation(sign * speed, loads)
        marks: list[Mark] = [
            Points(points.speed[rows], points.magnitude[rows], "measured", color=6, size=3.0),
            Band(speed, torque - reach, torque + reach, "95 % interval", color=0),
            Line(speed, torque, "identified", color=0),
        ]
        if network is not None:
            followed = sign * np.asarray(network.torque(sign * speed, loads))
            marks.append(Line(speed, followed, "exported network", color=1, stroke="dashed"))
        labels = f"speed [{model.position_unit}/s]", f"friction [{model.torque_unit}]"
        panels.append(Panel(tuple(marks), *labels, name, x_scale="log"))
    return Chart("friction-curve", "Friction over speed", tuple(panels), columns=2)
