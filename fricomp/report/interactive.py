"""Draws a chart as an interactive plotly figure, the same marks as the PNG."""

from base64 import b64encode
from importlib.resources import files
from itertools import zip_longest
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.extras import needing
from fricomp.report.chart import CROWDED, Band, Bars, Chart, HeatMap, Line, Mark, Panel, Points, Rule, Values
from fricomp.report.thinning import thin

_SCRIPT = "plotly-cartesian.min.js.gz"
"""The project's own partial build, which has every trace that is drawn here, of the version that plotly brings whole:
`npm pack plotly.js-cartesian-dist-min`, then `gzip -9 -n`. Its licence stands beside it."""

_STROKE = {"solid": "solid", "dashed": "dash", "dotted": "dot"}
_AXIS = {"gridcolor": "#E8E8E8", "linecolor": "#888888", "ticks": "outside", "zerolinecolor": "#BBBBBB"}
_MARGIN = {"l": 70, "r": 20, "t": 62, "b": 54}
_GAP = 116.0  # between two rows, for the axis label of one, the title and the legend of the next [px]
_GAP_SHARED = 66.0  # the same where only the lowest row has an axis label [px]
_LEGEND_LINE = 20.0  # height of a line of the legend [px]
_NARROW = 500.0  # width that the names of bars have beside each other on any page [px]
_ON_BARS = "#4D4D4D"  # of intervals, which the page makes light where it is dark
_FEW = 200  # values that take no room, and are kept as they are
_UNSEEN = 1e-5  # of what a curve spans; the largest screens have 8,000 pixels
_LETTER, _SYMBOL, _PAGE = 7.0, 46.0, 980.0  # widths that decide how many lines a legend takes [px]


def plotly_script() -> str:
    """The script that every page needs once, as base64 of gzip, which the page unpacks: a tenth of all of plotly.js."""
    return b64encode(files("fricomp.report").joinpath(_SCRIPT).read_bytes()).decode()


def draw_interactive(chart: Chart) -> str:
    """`chart` as a piece of HTML, without plotly's own script.

    Raises:
        MissingExtraError: plotly is not installed.
    """
    with needing("plotly", "report"):
        from plotly.io import to_html
        from plotly.subplots import make_subplots
    gap = _GAP_SHARED if chart.share_x else _GAP
    height = chart.rows * chart.panel_height + (chart.rows - 1) * gap + _MARGIN["t"] + _MARGIN["b"]
    inner = height - _MARGIN["t"] - _MARGIN["b"]
    figure = make_subplots(
        rows=chart.rows,
        cols=chart.columns,
        shared_xaxes="all" if chart.share_x else False,
        vertical_spacing=gap / inner if chart.rows > 1 else 0.0,
        horizontal_spacing=0.09 if chart.columns > 1 else 0.0,
        subplot_titles=[panel.title for panel in chart.panels],
    )
    lines = chart.legend_lines(_LETTER, _SYMBOL, _PAGE)
    height += max(lines) * _LEGEND_LINE - _LEGEND_LINE
    shown: set[tuple[str, str]] = set()
    for number, panel in enumerate(chart.panels):
        place = {"row": number // chart.columns + 1, "col": number % chart.columns + 1}
        _draw_panel(figure, panel, place, number, shown)
    drawn = figure.to_dict()
    drawn["layout"]["shapes"] = [
        rule for number, panel in enumerate(chart.panels) for rule in _draw_rules(panel, number)
    ]
    _set_layout(drawn["layout"], chart, height, lines)
    html: str = to_html(
        drawn,
        validate=False,
        full_html=False,
        include_plotlyjs=False,
        div_id=f"chart-{chart.name}",
        config={
            "displayModeBar": "hover",
            "displaylogo": False,
            "responsive": True,
            "modeBarButtonsToRemove": ["lasso2d", "select2d"],
        },
    )
    return html


def _set_layout(layout: dict[str, Any], chart: Chart, height: float, lines: tuple[int, ...]) -> None:
    """Fonts, margins, axes, legends, and each panel's title at its left edge.

    The layout is a plain dictionary by now: plotly looks through all of a figure on each of its updates, which is most
    of what a page costs.
    """
    layout |= {
        "height": height,
        "margin": _MARGIN | {"t": _MARGIN["t"] + (max(lines[: chart.columns]) - 1) * _LEGEND_LINE},
        "plot_bgcolor": "white",
        "paper_bgcolor": "white",
        "font": {"family": "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif", "size": 13, "color": "#222222"},
        "hovermode": "closest",
        "barmode": "group",
    }
    for number, panel in enumerate(chart.panels):
        x_axis, y_axis = layout[_name_axis("xaxis", number)], layout[_name_axis("yaxis", number)]
        x_axis |= _style_axis(panel, "x") | _label_bars(panel) | _turn_ticks(panel)
        y_axis |= _style_axis(panel, "y") | ({} if panel.y_range is None else {"range": list(panel.y_range)})
        layout[_name_axis("legend", number)] = _place_legend(y_axis["domain"][1], x_axis["domain"][0])
        if chart.share_x and number < len(chart.panels) - chart.columns:
            del x_axis["title"]
            x_axis["showticklabels"] = False
    titled = [number for number, panel in enumerate(chart.panels) if panel.title]
    for annotation, number in zip_longest(layout.get("annotations", ()), titled):
        if annotation is not None and number is not None:
            left = layout[_name_axis("xaxis", number)]["domain"][0]
            row = number - number % chart.columns
            shift = 2.0 + _LEGEND_LINE * max(lines[row : row + chart.columns])
            annotation |= {"x": left, "xanchor": "left", "yshift": shift, "font": {"size": 14, "weight": 600}}


def _name_axis(kind: str, number: int) -> str:
    return kind if number == 0 else f"{kind}{number + 1}"


def _draw_panel(figure: Any, panel: Panel, place: dict[str, int], number: int, shown: set[tuple[str, str]]) -> None:
    legend = _name_axis("legend", number)
    for mark, color in zip(panel.marks, panel.colors(), strict=True):
        for trace in _draw_traces(mark, color):
            if trace["type"] == "heatmap":
                trace["colorbar"] = _place_color_bar(figure, trace["colorbar"], number)
            else:
                trace["legend"] = legend
                if trace["type"] == "bar" and panel.has_lone_bars():
                    trace["offsetgroup"] = "middle"
                trace["showlegend"] = trace["showlegend"] and (trace["name"], color) not in shown
            figure.add_trace(trace, **place)
        shown.add((getattr(mark, "label", ""), color))


def _draw_rules(panel: Panel, number: int) -> list[dict[str, Any]]:
    """Lines across a panel. As plain dictionaries, since plotly looks through all of a figure for each that it adds."""
    along = {axis: _name_axis(axis, number) for axis in ("x", "y")}
    rules = []
    for mark, color in zip(panel.marks, panel.colors(), strict=True):
        if isinstance(mark, Rule):
            other = "y" if mark.axis == "x" else "x"
            ends = {f"{mark.axis}0": mark.at, f"{mark.axis}1": mark.at, f"{other}0": 0, f"{other}1": 1}
            refs = {f"{mark.axis}ref": along[mark.axis], f"{other}ref": f"{along[other]} domain"}
            rules.append({"type": "line", "line": {"color": color, "width": 1.2, "dash": "dash"}, **ends, **refs})
    return rules


def _style_axis(panel: Panel, axis: str) -> dict[str, Any]:
    label, scale = (panel.x_label, panel.x_scale) if axis == "x" else (panel.y_label, panel.y_scale)
    return {"title": {"text": label, "standoff": 8}, "type": _choose_type(panel, axis), **_AXIS, **_log_ticks(scale)}


def _turn_ticks(panel: Panel) -> dict[str, Any]:
    crowded = any(len(mark.x_names) > CROWDED for mark in panel.marks if isinstance(mark, HeatMap))
    return {"tickangle": -90} if crowded else {}


def _choose_type(panel: Panel, axis: str) -> str:
    for mark in panel.marks:
        if isinstance(mark, HeatMap) and getattr(mark, f"{axis}_names"):
            return "category"
    return panel.x_scale if axis == "x" else panel.y_scale


def _label_bars(panel: Panel) -> dict[str, Any]:
    """Names below the bars. Bars stand at their number: plotly stacks those that share a name as a category."""
    names = max((mark.categories for mark in panel.marks if isinstance(mark, Bars)), key=len, default=())
    if not names:
        return {}
    ticks = {"tickmode": "array", "tickvals": list(range(len(names))), "ticktext": list(names), "zeroline": False}
    if sum(map(len, names)) * _LETTER < _NARROW:
        return ticks
    # Names that slope down to the right would end outside of the chart, and plotly leaves out those that do.
    return ticks | {"tickangle": -35, "automargin": True, "ticklabeloverflow": "allow"}


def _log_ticks(scale: str) -> dict[str, Any]:
    return {"dtick": 1, "exponentformat": "power", "minor": {"ticks": "outside"}} if scale == "log" else {}


def _place_legend(top: float, left: float) -> dict[str, Any]:
    """Above the panel, below its title."""
    return {
        "orientation": "h", "x": left, "xanchor": "left", "y": top, "yanchor": "bottom", "font": {"size": 12},
        "traceorder": "normal", "bgcolor": "rgba(255,255,255,0)",
    }  # fmt: skip


def _place_color_bar(figure: Any, bar: dict[str, Any], number: int) -> dict[str, Any]:
    low, high = figure.layout[_name_axis("yaxis", number)].domain
    right = figure.layout[_name_axis("xaxis", number)].domain[1]
    return bar | {"len": high - low, "y": (low + high) / 2.0, "x": right, "xanchor": "left", "thickness": 14}


def _draw_traces(mark: Mark, color: str) -> list[dict[str, Any]]:
    named = {"name": getattr(mark, "label", ""), "showlegend": bool(getattr(mark, "label", ""))}
    match mark:
        case Line():
            x, y = map(_shorten, thin(mark.x, mark.y))
            line = {"color": color, "width": mark.width * 1.25, "dash": _STROKE[mark.stroke]}
            return [{"type": "scatter", "mode": "lines", "x": x, "y": y, "line": line, **named}]
        case Points():
            symbol = "circle-open" if mark.hollow else "circle"
            marker = {"color": color, "size": mark.size * 1.35, "symbol": symbol}
            x, y = _shorten(mark.x), _shorten(mark.y)
            points = {"type": "scatter", "mode": "markers", "x": x, "y": y, "marker": marker, **named}
            return [points | _draw_error(mark)]
        case Band():
            x, low, high = _shorten(mark.x), _shorten(mark.low), _shorten(mark.high)
            edge = {"type": "scatter", "mode": "lines", "x": x, "line": {"width": 0}, "hoverinfo": "skip"}
            fill = {"fill": "tonexty", "fillcolor": f"rgba({_format_rgb(color)},0.22)", **named}
            return [{**edge, "y": low, "name": "", "showlegend": False}, {**edge, "y": high, **fill}]
        case Bars():
            bars = {
                "type": "bar",
                "x": list(range(len(mark.categories))),
                "y": mark.values,
                **_write_hover(mark),
                **named,
            }
            return [bars | {"marker": {"color": color}} | _draw_error(mark)]
        case HeatMap():
            scale: dict[str, Any] = {"colorscale": "Viridis", "showscale": bool(mark.color_label)}
            if mark.diverging:
                scale |= {"colorscale": "RdBu", "reversescale": True, "zmid": 0.0}
            if mark.limits is not None:
                scale |= {"zmin": mark.limits[0], "zmax": mark.limits[1]}
            grid: dict[str, Any] = {"x": mark.x_names or mark.x, "y": mark.y_names or mark.y, "z": mark.values}
            grid |= {"text": mark.texts, "texttemplate": "%{text}"} if mark.texts else {}
            return [{"type": "heatmap", **grid, "colorbar": {"title": {"text": mark.color_label}}, **scale}]
        case Rule():
            line = {"color": color, "width": 1.2, "dash": "dash"}
            empty = {"type": "scatter", "mode": "lines", "x": [None], "y": [None], "line": line}
            return [{**empty, **named}] if mark.label else []


def _shorten(values: Values) -> NDArray[Any]:
    """Values in four bytes each where a curve of them looks the same: the page is read over networks and kept."""
    if values.size < _FEW or not np.isfinite(values).any():
        return values
    short = values.astype(np.float32)
    span = float(np.nanmax(values) - np.nanmin(values))
    off = np.nanmax(np.abs(short - values)) if np.isfinite(span) else np.inf
    return short if off <= _UNSEEN * span else values


def _write_hover(mark: Bars) -> dict[str, Any]:
    """The category's name beside the value, in place of its number."""
    return {"customdata": mark.categories, "hovertemplate": "%{customdata}: %{y}<extra>%{fullData.name}</extra>"}


def _draw_error(mark: Points | Bars) -> dict[str, Any]:
    if mark.error is None:
        return {}
    look = (
        {"thickness": 1.6, "width": 4, "color": _ON_BARS} if isinstance(mark, Bars) else {"thickness": 1.2, "width": 0}
    )
    return {"error_y": {"type": "data", "array": mark.error, **look}}


def _format_rgb(color: str) -> str:
    return ",".join(str(int(color[i : i + 2], 16)) for i in (1, 3, 5))
