"""One chart for each figure of [luo2024pinn] that shows data or a course, convergence, and the spread over draws."""

from typing import Any

import numpy as np

from fricomp.calibration.identification import identify
from fricomp.laws import FloatArray
from fricomp.report import Chart, Line, Panel, Points, Rule

from ..kit.store import RowStore
from .printed import NOISE_FREE, NOISY
from .problem import NOISE_READINGS, PARAMETERS, PaperProblem, Reading
from .rival_summary import find_best_adam, name_of
from .rivals import PAPER_LENGTH
from .study import SPREADS

_FIGURES = {
    "none": {"PSO": "figures 4 and 5", "GA": "figures 6 and 7", "Adam": "the paper's own training, figure 3"},
    "noise": {"PSO": "figures 9 and 10", "GA": "figures 11 and 12", "Adam": "the paper's own training, figure 8"},
}
_THOUSAND = 1000.0
_ITERATION = "iteration [thousands]"
_READINGS: tuple[Reading, ...] = ("none", *NOISE_READINGS)

_PINN = next(row for row in NOISY if row.method == "PINN")


def draw_benchmark_charts(ledger: RowStore) -> list[Chart]:
    """Charts of what the ledger holds."""
    rows = [
        row for row in ledger.rows(study="search", seed=0, iterations=PAPER_LENGTH) if row["method"] in ("PSO", "GA")
    ]
    rows += [row for reading in _READINGS for row in find_best_adam(ledger, reading)]
    known = [reading for reading in NOISE_READINGS if ledger.rows(study="statistics", reading=reading)]
    noise_free = [row for row in rows if row["method"] != "Adam" and row["reading"] == "none"]
    noise_free += _find_median_and_best(ledger.rows(study="adam", reading="none", iterations=PAPER_LENGTH))
    return [
        _draw_data(),
        *([_draw_convergence(noise_free)] if noise_free else []),
        *(_draw_own(reading) for reading in _READINGS),
        *(_draw_course(row) for row in rows),
        *(_draw_errors(ledger, reading) for reading in known),
    ]


def _draw_data() -> Chart:
    panels = []
    for reading in _READINGS:
        draw = PaperProblem().draw(reading, 0)
        marks = (Points(draw.velocity, draw.torque, size=3.0),)
        panels.append(Panel(marks, "velocity [rad/s]", "friction [N·m]", f"noise: {reading}"))
    return Chart("data", "The data (figure 2)", tuple(panels), columns=3)


def _draw_convergence(rows: list[dict[str, Any]]) -> Chart:
    """Mean error over the iterations, without noise, beside what the paper prints."""
    printed = {row.method: float(row.recomputed().mean()) for row in NOISE_FREE}
    panels = []
    for title, methods, named, low in (
        ("searches", ("PSO", "GA"), ("PSO", "GA"), 1e-14),
        ("Adam (factor of its starts)", ("Adam",), ("PINN",), 1e-6),
    ):
        lines = [
            Line(*_compute_mean_error(row), row.get("place", name_of(row))) for row in rows if row["method"] in methods
        ]
        rules = [Rule(printed[name], label=f"{name} as printed", color=k) for k, name in enumerate(named)]
        if lines:
            marks: tuple[Line | Rule, ...] = (*lines, *rules)
            panels.append(Panel(marks, _ITERATION, "mean |error| [%]", title, y_scale="log", y_range=(low, 1e4)))
    title = "Without noise the methods differ in how far they have converged"
    return Chart("convergence-none", title, tuple(panels), columns=2, panel_height=380)


def _find_median_and_best(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of each spread of the starts the median training and the best, by where they end."""
    chosen = []
    for spread in SPREADS:
        started = [row for row in rows if row["spread"] == spread]
        ranked = sorted(started, key=lambda row: float(_compute_mean_error(row)[1][-1]))
        places = (("median", len(ranked) // 2), ("best", 0)) if ranked else ()
        chosen += [ranked[k] | {"place": f"{name} ({spread:g})"} for name, k in places]
    return chosen


def _compute_mean_error(row: dict[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Thousands of iterations and mean |error| [%], down to rounding."""
    error = [PaperProblem().compute_mean_error(values) for values in row["course"]]
    return np.array(row["fitness"])[:, 0] / _THOUSAND, np.maximum(error, 1e-13)


def _draw_own(reading: Reading) -> Chart:
    draw = PaperProblem().draw(reading, 0)
    result = identify(draw.velocity, draw.torque, noise="absolute" if reading == "none" else reading)
    traces = result.traces
    assert traces is not None
    step = np.arange(1.0, len(traces.data_loss) + 1.0)
    figure = "3" if reading == "none" else "8"
    title = f"Our PINN from the start of variable projection, noise: {reading} (figure {figure})"
    losses = (Line(step, traces.data_loss, "data"), Line(step, traces.model_loss, "closed form"))
    loss = Panel(losses, "iteration", "mean squared error [(N·m)²]", "loss", y_scale="log")
    return Chart(f"pinn-{reading}", title, (loss, *_draw_directions(step, traces.parameters, "iteration")), columns=3)


def _draw_course(row: dict[str, Any]) -> Chart:
    method, reading = row["method"], row["reading"]
    fitness, course = np.array(row["fitness"]), np.array(row["course"])
    figures = _FIGURES["none" if reading == "none" else "noise"][method]
    step = fitness[:, 0] / _THOUSAND
    if method == "Adam":
        first = Panel((Line(step, fitness[:, 1]),), _ITERATION, "loss [(N·m)²]", "loss", y_scale="log")
    else:
        first = Panel((Line(step, fitness[:, 1]),), _ITERATION, "negative log-likelihood of the best", "fitness")
    title = f"{name_of(row)}, noise: {reading} ({figures})"
    return Chart(f"{method.lower()}-{reading}", title, (first, *_draw_directions(step, course, _ITERATION)), columns=3)


def _draw_directions(step: FloatArray, course: FloatArray, label: str) -> list[Panel]:
    """Parameters over the iterations, each divided by its true value."""
    true = np.array(PaperProblem().true_values)
    panels = []
    for direction, columns in (("forward", range(4)), ("reverse", range(4, 8))):
        lines = tuple(Line(step, course[:, k] / true[k], PARAMETERS[k]) for k in columns)
        panels.append(Panel(lines, label, "parameter / true value", direction))
    return panels


def _draw_errors(ledger: RowStore, reading: Reading) -> Chart:
    rows = ledger.rows(study="statistics", reading=reading)
    errors = np.sort([PaperProblem().compute_mean_error(row["values"]) for row in rows])
    share = np.linspace(0.0, 1.0, len(errors))
    marks = (Line(errors, share, "ours"), Rule(_PINN.average, "x", "printed for the paper's PINN, one draw"))
    panel = Panel(marks, "mean |error| of a draw [%]", "share of draws")
    return Chart(f"errors-{reading}", f"Mean error of {len(errors)} draws, {reading} noise", (panel,))
