"""One chart for each figure of [luo2024pinn] that shows a course, and the spread over draws."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricomp.report import Chart, Line, Panel, Points

from ..identification import identify
from .ledger import Ledger
from .problem import NOISE_READINGS, PARAMETERS, PaperProblem, Reading

__all__ = ["benchmark_charts"]

_FIGURES = {"PSO": "figures 4, 5, 9 and 10", "GA": "figures 6, 7, 11 and 12", "Adam": "figures 3 and 8"}


def benchmark_charts(ledger: Ledger) -> list[Chart]:
    """Charts of what the ledger holds."""
    rows = ledger.rows(study="search", seed=0) + ledger.rows(study="adam", seed=0)
    courses = [_course(row) for row in rows if row["method"] in _FIGURES and row["iterations"] >= 50_000]
    known = [reading for reading in NOISE_READINGS if ledger.rows(study="statistics", reading=reading)]
    return [_data(), _ours("none"), _ours("relative"), *courses, *(_errors(ledger, reading) for reading in known)]


def _data() -> Chart:
    panels = []
    for reading in ("none", *NOISE_READINGS):
        draw = PaperProblem().draw(reading, 0)
        marks = (Points(draw.velocity, draw.torque, size=3.0),)
        panels.append(Panel(marks, "velocity [rad/s]", "friction [N·m]", f"noise: {reading}"))
    return Chart("data", "The data (figure 2)", tuple(panels), columns=3)


def _ours(reading: Reading) -> Chart:
    draw = PaperProblem().draw(reading, 0)
    result = identify(draw.velocity, draw.torque, noise="absolute" if reading == "none" else reading)
    traces = result.traces
    assert traces is not None
    step = np.arange(1.0, len(traces.data_loss) + 1.0)
    names = "3" if reading == "none" else "8"
    return _parameters(f"pinn-{reading}", f"Our PINN, noise: {reading} (figure {names})", step, traces.parameters)


def _course(row: dict[str, Any]) -> Chart:
    fitness, course = np.array(row["fitness"]), np.array(row["course"])
    title = f"{row['method']}, noise: {row['reading']} ({_FIGURES[row['method']]})"
    chart = _parameters(f"{row['method'].lower()}-{row['reading']}", title, fitness[:, 0], course)
    best = Panel((Line(fitness[:, 0], fitness[:, 1], "best"),), "iteration", "objective", "fitness")
    return Chart(chart.name, title, (best, *chart.panels), columns=3)


def _parameters(name: str, title: str, step: Any, course: Any) -> Chart:
    true = np.array(PaperProblem().true_values)
    panels = []
    for direction, at in (("forward", slice(0, 4)), ("reverse", slice(4, 8))):
        lines = tuple(Line(step, course[:, k] / true[k], PARAMETERS[k]) for k in range(at.start or 0, at.stop or 8))
        panels.append(Panel(lines, "iteration", "parameter / true value", direction))
    return Chart(name, title, tuple(panels), columns=2)


def _errors(ledger: Ledger, reading: Reading) -> Chart:
    rows = ledger.rows(study="statistics", reading=reading)
    errors = np.sort([float(np.mean(PaperProblem().error_percent(np.array(row["values"])))) for row in rows])
    share = np.linspace(0.0, 1.0, len(errors))
    printed = Points(np.array([2.1671]), np.array([0.5]), "printed for the paper's PINN, one draw")
    panel = Panel((Line(errors, share, "ours"), printed), "mean |error| of a draw [%]", "share of draws")
    return Chart(f"errors-{reading}", f"Mean error over draws, {reading} noise", (panel,))
