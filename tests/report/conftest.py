import numpy as np
import pytest

from fricomp.report import Band, Bars, Chart, HeatMap, Line, Panel, Points, Rule


@pytest.fixture(scope="session")
def every_mark() -> Chart:
    """A chart with every kind of mark in it."""
    x = np.geomspace(0.01, 1.0, 20)
    curve = Panel(
        (
            Band(x, x - 0.1, x + 0.1, "interval", color=0),
            Line(x, x, "law", color=0),
            Points(x, x, "plateaus", error=0.1 * x, color=1),
            Points(x[:2], x[:2], "rejected", hollow=True),
            Rule(0.5, "x", "Stribeck velocity"),
        ),
        "speed [rad/s]",
        "torque [N·m]",
        "Forward",
        x_scale="log",
    )
    bars = Panel(
        (Bars(("a", "b"), np.array([1.0, 2.0]), "one"), Bars(("a", "b"), np.ones(2), error=x[:2])), "", "error [%]"
    )
    heat = Panel(
        (HeatMap(x[:2], x[:3], np.eye(3)[:, :2], "correlation", diverging=True, x_names=("a", "b")),), "", "", "Heat"
    )
    return Chart("every-mark", "Every mark", (curve, bars, heat), columns=2, caption="All of them.")
