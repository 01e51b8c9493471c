"""Draws a chart with matplotlib and without a display: as a figure, or as a PNG file."""

from __future__ import annotations

import os
import warnings
from contextlib import AbstractContextManager
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fricomp.extras import needing
from fricomp.report.chart import CROWDED, Band, Bars, Chart, HeatMap, Line, Mark, Panel, Points, Rule
from fricomp.report.thinning import thin
from fricomp.whole_file import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image

_DOTS_PER_INCH = 130
_WIDTH = 1100.0 / 100.0  # [in] for a page of 1100 px at the usual 100 px/in
_LETTER, _SYMBOL = 8.2, 56.0  # widths that decide how many lines a legend takes [px]
_LEGEND_LINE = 23.0  # height of a line of the legend [px]
_FEW_DECADES = 1e3  # highest over lowest value of a logarithmic axis whose ticks are plain numbers
_POINT = 72.0 / 100.0  # [pt/px]
_BLANK = "\u00a0"  # a title that shows nothing and takes its room
_STROKE = {"solid": "-", "dashed": "--", "dotted": ":"}
_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "text.parse_math": False,  # a dollar in a joint's name is a dollar
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#666666",
    "axes.labelcolor": "#222222",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.7,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "axes.titlesize": 12,
    "axes.titleweight": "bold",
    "legend.fontsize": 10,
}


def draw_png(chart: Chart, path: str | os.PathLike[str]) -> Path:
    """Write `chart` as a PNG file, whole or not at all.

    Returns:
        The path.

    Raises:
        MissingExtraError: matplotlib is not installed.
        OutputError: The file cannot be written.
    """
    target = Path(path)
    with _apply_style():
        _save(_draw(chart), target)
    return target


def draw_figure(chart: Chart) -> Figure:
    """Draw `chart` as a figure of matplotlib, which a notebook shows and `savefig` writes.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    with _apply_style():
        figure = _draw(chart)
        figure.draw_without_rendering()  # ticks are made when they are first drawn, in the style of that moment
    return figure


def _apply_style() -> AbstractContextManager[None]:
    with needing("matplotlib", "report"):
        from matplotlib import rc_context
    return rc_context(_STYLE)


def _draw(chart: Chart) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    lines = _count_legend_lines(chart)
    height = chart.rows * chart.panel_height + 70 + sum(lines[:: chart.columns]) * _LEGEND_LINE
    figure = _make_shown_figure()(figsize=(_WIDTH, height / 100.0), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(chart.title, x=0.01, ha="left", fontsize=14, fontweight="bold")
    axes = list(figure.subplots(chart.rows, chart.columns, squeeze=False, sharex=chart.share_x).flat)
    for ax in axes[len(chart.panels) :]:
        ax.remove()
    for ax, panel, named, above in zip(axes, chart.panels, chart.legends(), lines, strict=False):
        _draw_panel(figure, ax, panel, named, above)
        if chart.share_x:
            ax.label_outer()
    return figure


@cache
def _make_shown_figure() -> type[Figure]:
    """A figure that a notebook shows by itself, without a call that chooses a backend."""
    from matplotlib.figure import Figure

    class ShownFigure(Figure):
        def _repr_png_(self) -> bytes:
            full = BytesIO()
            self.savefig(full, dpi=_DOTS_PER_INCH, format="png")
            return full.getvalue()

    return ShownFigure


def _save(figure: Any, target: Path) -> None:
    """With a palette of its own: a third of the bytes of full colour, which lines and text do not need."""
    picture = _render(figure)
    with whole_file(target) as part:
        picture.quantize(256).save(part, format="PNG")


def _render(figure: Any) -> Image:
    """The figure in full colour, laid out and drawn once, which `savefig` does twice."""
    from PIL.Image import fromarray

    figure.dpi = _DOTS_PER_INCH
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a name in letters that the font has not
        figure.canvas.draw()
    return fromarray(np.array(figure.canvas.buffer_rgba())[:, :, :3])


def _count_legend_lines(chart: Chart) -> list[int]:
    """Lines of legend above each panel: those of the panel of its row that has most."""
    lines = chart.legend_lines(_LETTER, _SYMBOL, 0.9 * 100.0 * _WIDTH)
    starts = [number - number % chart.columns for number in range(len(lines))]
    return [max(lines[start : start + chart.columns]) for start in starts]


def _draw_panel(figure: Any, ax: Any, panel: Panel, named: tuple[str, ...], above: int) -> None:
    for order, (mark, color) in enumerate(zip(panel.marks, panel.colors(), strict=True)):
        _draw_mark(figure, ax, mark, color, _place_bars(panel, order))
    ax.set_xlabel(panel.x_label)
    ax.set_ylabel(panel.y_label)
    room = above * _LEGEND_LINE * _POINT
    ax.set_title(panel.title or _BLANK * bool(above), loc="left", pad=6.0 + room if panel.title else room - 10.0)
    for name, scale in (("x", panel.x_scale), ("y", panel.y_scale)):
        if scale == "log":
            _make_logarithmic(ax, name)
    if panel.y_range is not None:
        ax.set_ylim(panel.y_range)
    if named:
        _draw_legend(ax, named, above)


def _make_logarithmic(ax: Any, name: str) -> None:
    """Powers of ten along an axis; over few of them plain numbers at 1, 2 and 5."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    getattr(ax, f"set_{name}scale")("log")
    low, high = getattr(ax, f"get_{name}lim")()
    if high <= _FEW_DECADES * low:
        axis = getattr(ax, f"{name}axis")
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _draw_legend(ax: Any, named: tuple[str, ...], lines: int) -> None:
    """Between the panel and its title, where it covers nothing; the title keeps the room, so it may pass the panel."""
    handles, labels = ax.get_legend_handles_labels()
    known = dict(zip(labels, handles, strict=True))
    legend = ax.legend(
        [known[label] for label in named], named, loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False,
        ncols=-(-len(named) // lines), borderpad=0.0, borderaxespad=0.3, handlelength=1.6, columnspacing=1.6,
    )  # fmt: skip
    legend.set_in_layout(False)


def _draw_mark(figure: Any, ax: Any, mark: Mark, color: str, bar_place: tuple[float, float]) -> None:
    label = getattr(mark, "label", "") or None
    match mark:
        case Line():
            ax.plot(*thin(mark.x, mark.y), _STROKE[mark.stroke], color=color, lw=mark.width, label=label)
        case Points():
            face = "none" if mark.hollow else color
            ax.errorbar(
                mark.x, mark.y, mark.error, fmt="o", ms=mark.size, mfc=face, mec=color, ecolor=color, elinewidth=1,
                label=label,
            )  # fmt: skip
        case Band():
            ax.fill_between(mark.x, mark.low, mark.high, color=color, alpha=0.22, lw=0, label=label)
        case Bars():
            offset, width = bar_place
            places = np.arange(len(mark.categories))
            ax.bar(places + offset, mark.values, width, yerr=mark.error, color=color, label=label, capsize=2)
            ax.set_xticks(places, mark.categories, **_turn_names(mark.categories))
            ax.grid(axis="x", visible=False)
        case HeatMap():
            _draw_heat_map(figure, ax, mark)
        case Rule():
            draw = ax.axvline if mark.axis == "x" else ax.axhline
            draw(mark.at, color=color, lw=1.1, ls="--", label=label)


def _place_bars(panel: Panel, order: int) -> tuple[float, float]:
    """Where the bars of one mark stand beside those of the others, and their width."""
    bars = [i for i, mark in enumerate(panel.marks) if isinstance(mark, Bars)]
    if order not in bars:
        return 0.0, 0.8
    if panel.has_lone_bars():
        return 0.0, 0.5
    width = 0.8 / len(bars)
    return (bars.index(order) - (len(bars) - 1) / 2.0) * width, width


def _draw_heat_map(figure: Any, ax: Any, mark: HeatMap) -> None:
    limit = float(np.nanmax(np.abs(mark.values))) if np.any(np.isfinite(mark.values)) else 1.0
    limits = {"vmin": -limit, "vmax": limit} if mark.diverging else {}
    if mark.limits is not None:
        limits = {"vmin": mark.limits[0], "vmax": mark.limits[1]}
    colours = "RdBu_r" if mark.diverging else "viridis"
    mesh = ax.pcolormesh(_compute_edges(mark.x), _compute_edges(mark.y), mark.values, cmap=colours, **limits)
    if mark.color_label:
        figure.colorbar(mesh, ax=ax, label=mark.color_label)
    if mark.x_names:
        upright = {"rotation": 90} if len(mark.x_names) > CROWDED else None
        ax.set_xticks(mark.x, mark.x_names, **(upright or _turn_names(mark.x_names)))
    if mark.y_names:
        ax.set_yticks(mark.y, mark.y_names)
    for y, row in zip(mark.y, mark.texts, strict=False):
        for x, text in zip(mark.x, row, strict=True):
            ax.text(x, y, text, ha="center", va="center", fontsize=7, color="#FFFFFF", path_effects=_outline())
    ax.grid(visible=False)


def _outline() -> list[Any]:
    """Dark about light letters, which can be read on every colour."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=1.6, foreground="#222222")]


def _compute_edges(centres: np.ndarray) -> np.ndarray:
    """Edges of cells about `centres`; a lone cell is one wide."""
    if centres.size < 2:
        return np.concatenate([centres - 0.5, centres + 0.5])
    between = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2.0 * centres[0] - between[0]], between, [2.0 * centres[-1] - between[-1]]])


def _turn_names(names: tuple[str, ...]) -> dict[str, Any]:
    """Upright where names are few and short."""
    return {"rotation": 25, "ha": "right"} if len(names) * max(map(len, names)) > 60 else {}
