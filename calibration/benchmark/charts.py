"""One chart for each figure of [luo2024pinn] that shows data or a course, convergence, and the spread over draws."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricomp.laws import FloatArray
from fricomp.report import Chart, Line, Panel, Points, Rule

from ..identification import identify
from .ledger import Ledger
from .printed import NOISE_FREE
from .problem import NOISE_READINGS, PARAMETERS, PaperProblem, Reading
from .rival_summary import best_adam
from .rivals import PAPER_LENGTH
from .study import random_start

__all__ = ["benchmark_charts"]

_FIGURES = {
    "none": {"PSO": "figures 4 and 5", "GA": "figures 6 and 7", "Adam": "the paper's own training, figure 3"},
    "noise": {"PSO": "figures 9 and 10", "GA": "figures 11 and 12", "Adam": "the paper's own training, figure 8"},
}
_READINGS: tuple[Reading, ...] = ("none", *NOISE_READINGS)


def benchmark_charts(ledger: Ledger) -> list[Chart]:
    """Charts of what the ledger holds."""
    rows = [
        row for row in ledger.rows(study="search", seed=0, iterations=PAPER_LENGTH) if row["method"] in ("PSO", "GA")
    ]
    rows += [row for reading in _READINGS for row in best_adam(ledger, reading)]
    known = [reading for reading in NOISE_READINGS if ledger.rows(study="statistics", reading=reading)]
    noise_free = [row for row in rows if row["reading"] == "none"]
    return [
        _data(),
        *([_convergence(noise_free)] if noise_free else []),
        *(_ours(reading) for reading in _READINGS),
        *(_course(row) for row in rows),
        *(_errors(ledger, reading) for reading in known),
    ]


def _data() -> Chart:
    panels = []
    for reading in _READINGS:
        draw = PaperProblem().draw(reading, 0)
        marks = (Points(draw.velocity, draw.torque, size=3.0),)
        panels.append(Panel(marks, "velocity [rad/s]", "friction [N·m]", f"noise: {reading}"))
    return Chart("data", "The data (figure 2)", tuple(panels), columns=3)


def _convergence(rows: list[dict[str, Any]]) -> Chart:
    """Mean error over the iterations, without noise, beside what the paper prints."""
    lines = [Line(*_mean_error(row), str(row["method"])) for row in rows]
    rules = [
        Rule(float(printed.recomputed().mean()), label=f"{printed.method} as printed", color=5 + k)
        for k, printed in enumerate(NOISE_FREE)
    ]
    panel = Panel((*lines, *rules), "iteration", "mean |error| [%]", y_scale="log")
    title = "Without noise the methods differ in how far they have converged"
    return Chart("convergence-none", title, (panel,), panel_height=420)


def _mean_error(row: dict[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Iteration and mean |error| [%], down to rounding."""
    course = np.abs(np.array(row["course"]))  # Adam's v_s may be negative, it enters squared
    error = np.mean([PaperProblem().error_percent(values) for values in course], axis=1)
    return np.array(row["fitness"])[:, 0], np.maximum(error, 1e-13)


def _ours(reading: Reading) -> Chart:
    draw = PaperProblem().draw(reading, 0)
    noise = "absolute" if reading == "none" else reading
    result = identify(draw.velocity, draw.torque, noise=noise, options=random_start(0))
    traces = result.traces
    assert traces is not None
    step = np.arange(1.0, len(traces.data_loss) + 1.0)
    title = f"Our PINN from a random start, noise: {reading} (figure {'3' if reading == 'none' else '8'})"
    losses = (Line(step, traces.data_loss, "data"), Line(step, traces.model_loss, "closed form"))
    loss = Panel(losses, "iteration", "mean squared error [(N·m)²]", "loss", y_scale="log")
    return Chart(f"pinn-{reading}", title, (loss, *_directions(step, traces.parameters)), columns=3)


def _course(row: dict[str, Any]) -> Chart:
    method, reading = row["method"], row["reading"]
    fitness, course = np.array(row["fitness"]), np.array(row["course"])
    figures = _FIGURES["none" if reading == "none" else "noise"][method]
    log = method == "Adam"
    label = "loss [(N·m)²]" if log else "negative log-likelihood"
    best = Panel(
        (Line(fitness[:, 0], fitness[:, 1], "best"),), "iteration", label, "fitness", y_scale="log" if log else "linear"
    )
    title = f"{method}, noise: {reading} ({figures})"
    return Chart(f"{method.lower()}-{reading}", title, (best, *_directions(fitness[:, 0], course)), columns=3)


def _directions(step: FloatArray, course: FloatArray) -> list[Panel]:
    """Parameters over the iterations, each divided by its true value."""
    true = np.array(PaperProblem().true_values)
    panels = []
    for direction, columns in (("forward", range(4)), ("reverse", range(4, 8))):
        lines = tuple(Line(step, course[:, k] / true[k], PARAMETERS[k]) for k in columns)
        panels.append(Panel(lines, "iteration", "parameter / true value", direction))
    return panels


def _errors(ledger: Ledger, reading: Reading) -> Chart:
    rows = ledger.rows(study="statistics", reading=reading)
    errors = np.sort([float(np.mean(PaperProblem().error_percent(np.array(row["values"])))) for row in rows])
    share = np.linspace(0.0, 1.0, len(errors))
    marks = (Line(errors, share, "ours"), Rule(2.1671, "x", "printed for the paper's PINN, one draw"))
    panel = Panel(marks, "mean |error| of a draw [%]", "share of draws")
    return Chart(f"errors-{reading}", f"Mean error of {len(errors)} draws, {reading} noise", (panel,))
