"""Where the mismatch sits: residual over noise in bins of one quantity, and of two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.laws import FloatArray
from fricomp.report import Band, Chart, HeatMap, Line, Mark, Panel, Rule

from ..record.result import Evidence, Interval, Location, RowSeries
from .over_time import AFTER, BEFORE, NOISE
from .settings import REPORT
from .wording import AXIS_TITLES, Units, describe_name

_ORDER = ("velocity", "position", "load_torque", "time_since_reversal", "temperature", "acceleration", "time")


def draw_map_chart(evidence: Evidence, location: Location, units: Units, models: tuple[str, ...]) -> Chart | None:
    """Residual over noise by velocity, position, load, time since reversal, temperature, acceleration, time."""
    quantities = [name for name in _ORDER if name in evidence.maps] + sorted(set(evidence.maps) - set(_ORDER))
    panels = tuple(
        _draw_panel(name, evidence.maps[name], location.get(name, []), evidence.series, (units, models))
        for name in quantities
    )
    if not panels:
        return None
    return Chart(
        "where",
        "Residual over its noise",
        panels,
        columns=2 if len(panels) > 1 else 1,
        caption="1 is what a joint with nothing missing shows on the whole; at rest and just after it has turned round "
        "it shows less. Bands are 95 % over blocks of time"
        + ("; the mismatch sits in the marked stretches." if any(location.values()) else "."),
        panel_height=230,
    )


def _draw_panel(
    name: str,
    found: Mapping[str, FloatArray],
    located: Sequence[Interval],
    series: Sequence[RowSeries],
    style: tuple[Units, tuple[str, ...]],
) -> Panel:
    units, models = style
    edges = np.asarray(found["edges"])
    before = _compute_ratio(found["excess"])
    low, high = _compute_ratio(found["lower"]), _compute_ratio(found["upper"])
    after = _compute_ratio(found["excess_after"]) if "excess_after" in found else _bin_after(name, edges, series)
    top = float(np.nanmax(np.concatenate([high, [1.2]])))
    marks: list[Mark] = [
        Band(np.array(span), np.zeros(2), np.full(2, 1.05 * top), "located here" if i == 0 else "", color=4)
        for i, span in enumerate(located)
    ]
    x = np.repeat(edges, 2)[1:-1]  # each bin as a level line
    marks.append(Band(x, np.repeat(low, 2), np.repeat(high, 2), color=BEFORE))
    marks.append(Line(x, np.repeat(before, 2), models[0], color=BEFORE))
    if len(models) > 1 and after is not None:
        marks.append(Line(x, np.repeat(after, 2), models[1], color=AFTER))
    marks.append(Rule(1.0, "y", color=NOISE))
    title = AXIS_TITLES.get(name, describe_name(name)).capitalize()
    return Panel(tuple(marks), units.label_axis(name), "residual / noise [1]", title, y_range=(0.0, 1.05 * top))


def _compute_ratio(excess: FloatArray) -> FloatArray:
    """RMS over noise from the energy above the noise in noise variances."""
    result: FloatArray = np.sqrt(np.maximum(1.0 + np.asarray(excess), 0.0))
    return result


def _bin_after(name: str, edges: FloatArray, series: Sequence[RowSeries]) -> FloatArray | None:
    """Residual over noise of the extended model in the same bins; None where the rows do not have the quantity."""
    columns = [getattr(one, name, None) for one in series]
    if not series or any(column is None for column in columns):
        return None
    values = np.concatenate([column for column in columns if column is not None])
    place = np.searchsorted(edges, values, side="right") - 1
    energy = np.concatenate([(one.after / one.spread) ** 2 for one in series])
    inside = (place >= 0) & (place < edges.size - 1)
    count = np.bincount(place[inside], minlength=edges.size - 1)
    total = np.bincount(place[inside], energy[inside], minlength=edges.size - 1)
    result: FloatArray = np.where(count >= REPORT.fewest, np.sqrt(total / np.maximum(count, 1)), np.nan)
    return result


def draw_plane_chart(series: Sequence[RowSeries], units: Units, models: tuple[str, ...]) -> Chart | None:
    """Residual over noise over velocity and position, and over velocity and load, before and after."""
    panels: list[Panel] = []
    for name in ("position", "load_torque"):
        column = np.concatenate([getattr(one, name) for one in series]) if series else np.zeros(0)
        if column.size and float(np.ptp(column)) > 1e-9 * max(float(np.max(np.abs(column))), 1e-9):
            panels += _draw_plane(name, series, units, models)
    if not panels:
        return None
    caption = "Colour is the RMS of the missing torque over its noise in each cell"
    caption += "; the same scale for both models." if len(models) > 1 else "."
    return Chart("planes", "Over two quantities", tuple(panels), columns=len(models), caption=caption)


def _draw_plane(name: str, series: Sequence[RowSeries], units: Units, models: tuple[str, ...]) -> list[Panel]:
    x = np.concatenate([getattr(one, name) for one in series])
    v = np.concatenate([one.velocity for one in series])
    x_edges, v_edges = _place_edges(x, REPORT.bins[0]), _place_edges(v, REPORT.bins[1])
    grids = [_bin_cells((x, v), (x_edges, v_edges), series, side) for side in ("before", "after")[: len(models)]]
    largest = max((float(np.nanmax(grid)) for grid in grids if np.any(np.isfinite(grid))), default=1.0)
    limits = (0.0, max(largest, 1.5))
    labels = ("", "residual / noise")[-len(models) :]
    return [
        Panel(
            (HeatMap(_find_middles(x_edges), _find_middles(v_edges), grid, label, limits=limits),),
            units.label_axis(name),
            units.label_axis("velocity"),
            model.capitalize(),
        )
        for grid, model, label in zip(grids, models, labels, strict=True)
    ]


def _bin_cells(
    at: tuple[FloatArray, FloatArray], edges: tuple[FloatArray, FloatArray], series: Sequence[RowSeries], side: str
) -> FloatArray:
    energy = np.concatenate([(getattr(one, side) / one.spread) ** 2 for one in series])
    total = np.histogram2d(*at, bins=edges, weights=energy)[0]
    count = np.histogram2d(*at, bins=edges)[0]
    result: FloatArray = np.where(count >= REPORT.fewest_of_plane, np.sqrt(total / np.maximum(count, 1)), np.nan).T
    return result


def _place_edges(values: FloatArray, count: int) -> FloatArray:
    """Even edges over all but the rarest values."""
    low, high = (float(value) for value in np.quantile(values, (REPORT.rarest, 1.0 - REPORT.rarest)))
    return np.linspace(low, high, count + 1)


def _find_middles(edges: FloatArray) -> FloatArray:
    result: FloatArray = 0.5 * (edges[1:] + edges[:-1])
    return result
