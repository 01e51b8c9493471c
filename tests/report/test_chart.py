"""Charts as plain data."""

import subprocess
import sys

import numpy as np
import pytest

from fricomp.errors import ParameterError
from fricomp.report import PALETTE, Bars, Chart, HeatMap, Line, Panel, Points
from fricomp.report.thinning import thin


def test_columns_of_different_length_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"x \(3,\), y \(2,\)"):
        Line(np.zeros(3), np.zeros(2))


def test_marks_are_read_only_copies() -> None:
    y = np.zeros(3)
    line = Line(np.arange(3.0), y)
    y[0] = 5.0
    assert line.y[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        line.y[0] = 1.0


def test_bars_and_heat_maps_check_their_shape() -> None:
    with pytest.raises(ParameterError, match="categories"):
        Bars(("a",), np.zeros(2))
    with pytest.raises(ParameterError, match="heat map over 2 x 3"):
        HeatMap(np.zeros(3), np.zeros(2), np.zeros((3, 2)))
    with pytest.raises(ParameterError, match="one text a cell"):
        HeatMap(np.zeros(3), np.zeros(2), np.zeros((2, 3)), texts=(("a", "b", "c"),))


def test_colors_follow_the_order_unless_given() -> None:
    x = np.zeros(1)
    panel = Panel((Line(x, x), Points(x, x, color=4), Line(x, x)), "", "")
    assert panel.colors() == (PALETTE[0], PALETTE[4], PALETTE[1])


def test_a_legend_names_what_no_earlier_panel_has_named() -> None:
    x = np.zeros(1)
    panels = (
        Panel((Line(x, x, "law", color=0), Points(x, x, color=1)), "", ""),
        Panel((Line(x, x, "law", color=0), Line(x, x, "data", color=1)), "", ""),
        Panel((Line(x, x, "law", color=2),), "", ""),
    )
    chart = Chart("three", "Three", panels, columns=3)
    assert chart.legends() == (("law",), ("data",), ("law",))
    assert chart.legend_lines(letter=10.0, symbol=20.0, width=150.0) == (1, 2, 1)


def test_a_legend_takes_the_room_of_neighbours_that_have_none() -> None:
    x = np.zeros(1)
    panels = (Panel((Line(x, x, "a long name"),), "", ""), Panel((Line(x, x),), "", ""))
    assert Chart("two", "Two", panels, columns=2).legend_lines(10.0, 20.0, 200.0) == (1, 0)
    assert Chart("two", "Two", panels[::-1], columns=2).legend_lines(10.0, 20.0, 200.0) == (0, 2)


def test_bars_stand_alone_where_no_category_has_two() -> None:
    names, nan = ("a", "b"), np.nan
    one, other = Bars(names, np.array([1.0, nan])), Bars(names, np.array([nan, 2.0]))
    assert Panel((one, other), "", "").has_lone_bars()
    assert not Panel((one, other, one), "", "").has_lone_bars()


def test_bars_of_one_name_are_two_places() -> None:
    names, nan = ("a", "a"), np.nan
    one, other = Bars(names, np.array([1.0, nan])), Bars(names, np.array([nan, 2.0]))
    assert Panel((one, other), "", "").has_lone_bars()


def test_a_chart_needs_a_panel() -> None:
    with pytest.raises(ParameterError, match="at least one panel"):
        Chart("empty", "Empty", ())


def test_thinning_keeps_ends_and_peaks() -> None:
    x = np.linspace(0.0, 1.0, 100_000)
    y = np.sin(50.0 * x)
    y[31_415] = 7.0
    few_x, few_y = thin(x, y, limit=1000)
    assert few_x.size <= 1002
    assert few_y.max() == 7.0
    assert (few_x[0], few_x[-1]) == (0.0, 1.0)
    assert np.all(np.diff(few_x) > 0.0)


def test_thinning_keeps_gaps() -> None:
    y = np.ones(10_000)
    y[5000] = np.nan
    assert np.isnan(thin(np.arange(10_000.0), y, limit=100)[1]).sum() == 1


def test_the_data_classes_import_no_plotting() -> None:
    script = "import sys, fricomp.report; assert not {'matplotlib', 'plotly', 'jinja2'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", script], check=True)
