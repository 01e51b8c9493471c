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


def test_colors_follow_the_order_unless_given() -> None:
    x = np.zeros(1)
    panel = Panel((Line(x, x), Points(x, x, color=4), Line(x, x)), "", "")
    assert panel.colors() == (PALETTE[0], PALETTE[4], PALETTE[1])


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
