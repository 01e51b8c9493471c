"""Charts as plain data, drawn as PNG and as interactive HTML, and report pages of one offline file."""

from fricomp.report.chart import PALETTE, Band, Bars, Chart, HeatMap, Line, Mark, Panel, Points, Rule
from fricomp.report.markdown import format_markdown_table
from fricomp.report.page import Check, Outcome, ReportPage, Section, Table, write_report
from fricomp.report.png import draw_figure, draw_png

__all__ = [
    "PALETTE",
    "Band",
    "Bars",
    "Chart",
    "Check",
    "HeatMap",
    "Line",
    "Mark",
    "Outcome",
    "Panel",
    "Points",
    "ReportPage",
    "Rule",
    "Section",
    "Table",
    "draw_figure",
    "draw_png",
    "format_markdown_table",
    "write_report",
]
