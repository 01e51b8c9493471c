"""Report pages and PNG files."""

import json
import re
import struct
from base64 import b64decode
from collections.abc import Callable
from dataclasses import replace
from gzip import decompress
from hashlib import sha256
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from plotly.offline import get_plotlyjs_version

from fricomp.errors import ParameterError
from fricomp.report import Bars, Chart, Check, HeatMap, Line, Panel, ReportPage, Section, Table, draw_png, write_report
from fricomp.report.interactive import draw_interactive, plotly_script
from fricomp.report.page import describe_chart

pytestmark = pytest.mark.usefixtures("drawn_charts")


@pytest.fixture(scope="module")
def page(every_mark: Chart) -> ReportPage:
    table = Table(("parameter", "value"), (("coulomb_torque", "1.0 ± 0.1"), ("<b>", "2.0")), "Parameters")
    checks = (Check("sign", "passed", "right"), Check("drift", "warning", "1.2 %"))
    sections = (Section("Curve", (every_mark, table)), Section("Checks", (*checks, "Some text."), folded=True))
    return ReportPage("Friction of joint elbow", ("It is fine.",), sections, "today", {"plateaus": "40"})


@pytest.fixture(scope="module")
def html(page: ReportPage, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_report(page, tmp_path_factory.mktemp("report") / "report.html")


def test_the_page_loads_nothing_from_elsewhere(html: Path) -> None:
    tags = re.findall(
        r"<(?:script|link|img|iframe)\b[^>]*>", re.sub(r"<script>.*?</script>", "", html.read_text(), flags=re.S)
    )
    assert not [tag for tag in tags if "src=" in tag or "href=" in tag]


def test_the_page_carries_plotly_once_packed_and_is_small(html: Path) -> None:
    """Which leaves more than a megabyte for the data of its charts."""
    assert html.read_text().count(plotly_script()) == 1
    assert html.stat().st_size < 800_000


def test_the_script_is_the_published_part_of_the_plotly_that_is_pinned() -> None:
    script = decompress(b64decode(plotly_script()))
    assert sha256(script).hexdigest() == "79542150855a52c567260e3137095dbe2b744e6d702a5cabe67da246942fba7a"
    named = re.match(rb"/\*\*\n\* plotly\.js \(cartesian - minified\) v([0-9.]+)\n", script)
    assert named is not None
    lock = (Path(__file__).parents[2] / "requirements.lock").read_text("utf-8").split()
    if f"plotly=={version('plotly')}" in lock:
        assert named[1].decode() == get_plotlyjs_version()


def test_summary_comes_before_the_sections_and_text_is_escaped(html: Path) -> None:
    text = html.read_text()
    assert text.index("It is fine.") < text.index("Every mark")
    assert "&lt;b&gt;" in text


def test_a_page_without_charts_carries_no_script(tmp_path: Path) -> None:
    path = write_report(ReportPage("Plain", ("Nothing.",), ()), tmp_path / "plain.html")
    assert path.stat().st_size < 20_000


def test_a_table_refuses_rows_of_another_length() -> None:
    with pytest.raises(ParameterError, match="2 columns has a row of 1"):
        Table(("a", "b"), (("1",),))


def _figure(chart: Chart) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Traces and layout, as the page hands them to plotly."""
    text = draw_interactive(chart).partition("Plotly.newPlot(")[2]
    decoder = json.JSONDecoder()
    start = text.index("[")
    traces, end = decoder.raw_decode(text, start)
    layout, _ = decoder.raw_decode(text, text.index("{", end))
    return traces, layout


def test_bars_of_one_name_stand_side_by_side_in_the_page() -> None:
    names, nan = ("ripple", "spring", "spring", "spring"), np.nan
    named = Bars(names, np.array([9.0, nan, nan, nan]), "named")
    refused = Bars(names, np.array([nan, 8.0, 7.0, 6.0]), "refused")
    traces, layout = _figure(Chart("rivals", "Rivals", (Panel((named, refused), "", "evidence"),)))
    assert [trace["x"] for trace in traces] == [[0, 1, 2, 3], [0, 1, 2, 3]]
    axis = layout["xaxis"]
    assert (axis["tickvals"], axis["ticktext"]) == ([0, 1, 2, 3], list(names))
    assert axis["type"] == "linear"
    assert not axis["zeroline"]  # through the first bar, whose number is 0
    assert [trace["offsetgroup"] for trace in traces] == ["middle", "middle"]


@pytest.mark.parametrize(("name", "angle"), [("spring", None), ("presliding_hysteresis + load_coulomb", -35)])
def test_long_names_below_bars_slope_so_that_the_last_ones_are_drawn(name: str, angle: float | None) -> None:
    bars = Bars((name,) * 7, np.arange(7.0), "gain")
    axis = _figure(Chart("rivals", "Rivals", (Panel((bars,), "", "evidence"),)))[1]["xaxis"]
    assert axis.get("tickangle") == angle
    assert axis.get("ticklabeloverflow") == (None if angle is None else "allow")


@pytest.mark.parametrize(("rows", "columns"), [(1, 3), (3, 1), (1, 1), (2, 3)])
def test_a_heat_map_of_any_size_is_filled(rows: int, columns: int, tmp_path: Path) -> None:
    heat = HeatMap(np.arange(float(columns)), np.arange(float(rows)), np.ones((rows, columns)), limits=(0.0, 1.0))
    file = draw_png(Chart("heat", "Heat", (Panel((heat,), "x", "y"),)), tmp_path / "heat.png")
    pixels = imread(file)[:, :, :3]
    yellow = np.all(np.abs(pixels - np.array([0.993, 0.906, 0.144])) < 0.02, axis=2)
    assert np.mean(yellow) > 0.5


def test_texts_stand_in_the_cells(tmp_path: Path) -> None:
    heat = HeatMap(np.arange(2.0), np.arange(1.0), np.ones((1, 2)))
    bare, written = (
        Chart("heat", "Heat", (Panel((each,), "x", "y"),)) for each in (heat, replace(heat, texts=(("17", ""),)))
    )
    assert '"text":[["17",""]]' in draw_interactive(written)
    assert "texttemplate" not in draw_interactive(bare)
    pixels = [imread(draw_png(chart, tmp_path / "heat.png"))[:, :, :3] for chart in (bare, written)]
    left, right = np.array_split(np.any(np.abs(pixels[0] - pixels[1]) > 0.3, axis=2), 2, axis=1)
    assert left.sum() > 20
    assert right.sum() == 0


def test_a_png_has_the_size_the_chart_asks_for(every_mark: Chart, tmp_path: Path) -> None:
    data = draw_png(every_mark, tmp_path / "chart.png").read_bytes()
    width, height = struct.unpack(">II", data[16:24])
    legends = 2 * 23  # a line of labels above each row of panels
    assert (width, height) == (1430, int((2 * every_mark.panel_height + 70 + legends) * 1.3))


def test_a_column_is_flush_right_where_it_holds_numbers_or_dashes() -> None:
    table = Table(("name", "fall", "remark"), (("a", "–", "–"), ("b", "74% to 82%", "2 of them"), ("c", "", "none")))
    assert table.numeric == (False, True, False)
    assert Table(("a", "b"), ()).numeric == (False, False)


@pytest.mark.slow
def test_a_browser_draws_every_chart_without_a_network(html: Path, open_page: Callable[[Path], Any]) -> None:
    shown = open_page(html)
    assert all(f'class="subplot {axes}"' in shown.dom for axes in ("xy", "x2y2", "x3y3"))
    assert ">Stribeck velocity</text>" in shown.dom
    assert (shown.complaints, shown.fetched) == ((), ())


@pytest.mark.slow
def test_the_browser_tells_of_a_broken_script_and_of_what_a_page_fetches(
    tmp_path: Path, open_page: Callable[[Path], Any]
) -> None:
    address = "http://fonts.invalid/letters.css"
    page = tmp_path / "broken.html"
    page.write_text(f'<link rel="stylesheet" href="{address}"><script>missing();</script>')
    shown = open_page(page)
    assert "missing is not defined" in shown.complaints[0]
    assert shown.fetched == (address,)


def test_what_is_not_usable_says_so_first_and_in_colour(tmp_path: Path) -> None:
    page = ReportPage("Joint", ("The points do not say it.",), (), outcome="failed", verdict="Not usable")
    text = write_report(page, tmp_path / "page.html").read_text()
    assert '<section class="card summary failed">' in text
    assert text.index("Not usable") < text.index("The points do not say it.")
    assert ".failed .verdict { color: var(--bad); }" in text


def test_a_chart_has_an_alternative_in_words(html: Path, every_mark: Chart) -> None:
    text = html.read_text()
    alternative = describe_chart(every_mark)
    assert f'<div role="img" aria-label="{escape(alternative)}">' in text
    assert every_mark.title in alternative
    for panel in every_mark.panels:
        assert panel.y_label in alternative


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_charts_have_the_colours_of_the_page(
    html: Path, open_page: Callable[[Path], Any], scheme: str, tmp_path: Path
) -> None:
    shown = html.read_text().replace(
        "screen and (prefers-color-scheme: dark)", "screen" if scheme == "dark" else "not all"
    )
    asked = "dark.matches" if scheme == "light" else "true"
    page = tmp_path / f"{scheme}.html"
    page.write_text(shown.replace("if (dark.matches) await dress(false)", f"if ({asked}) await dress(false)"))
    opened = open_page(page)
    assert opened.complaints == ()
    assert ("rgb(28, 33, 40)" in opened.dom) == (scheme == "dark")


def test_a_page_is_made_for_phones_and_paper(html: Path) -> None:
    text = html.read_text()
    for query in ("@media (max-width: 640px)", "@media print", 'name="viewport"'):
        assert query in text


def test_a_curve_is_kept_in_half_the_room_where_it_looks_the_same() -> None:
    t = np.linspace(0.0, 60.0, 4000)
    wave = Chart("wave", "Wave", (Panel((Line(t, np.sin(t)),), "", ""),))
    stamps = Chart("wave", "Wave", (Panel((Line(t + 1.7e9, np.sin(t)),), "", ""),))
    (near,), (far,) = _figure(wave)[0], _figure(stamps)[0]
    assert (near["x"]["dtype"], near["y"]["dtype"]) == ("f4", "f4")
    assert (far["x"]["dtype"], far["y"]["dtype"]) == ("f8", "f4")
    drawn = np.frombuffer(b64decode(near["y"]["bdata"]), np.float32)
    assert np.max(np.abs(drawn - np.sin(t))) < 1e-5


def test_on_a_phone_panels_stand_below_each_other_with_one_legend(
    html: Path, open_page: Callable[[Path], Any], tmp_path: Path
) -> None:
    phone = tmp_path / "phone.html"
    phone.write_text(html.read_text().replace("if (innerWidth < 640)", "if (true)"))
    wide, narrow = open_page(html), open_page(phone)
    assert narrow.complaints == ()
    assert len(_panel_edges(wide.dom)) > len(_panel_edges(narrow.dom)) == 1
    assert [len(re.findall('<g class="legend[0-9]*"', page.dom)) for page in (wide, narrow)] == [2, 1]


def _panel_edges(dom: str) -> set[str]:
    """Where panels begin on the left."""
    return set(re.findall(r'<clippath class="axesclip" id="[a-z0-9]+x[0-9]*"><rect x="([0-9.]+)"', dom, re.IGNORECASE))
