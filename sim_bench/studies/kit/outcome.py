"""What a study gives: figures for machines, tables and charts for people, all in one folder."""

from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

from fricomp.report import Chart, ReportPage, Section, draw_png, write_report
from fricomp.whole_file import write_json

from .commit import find_commit, format_measured


@dataclass(frozen=True, eq=False)
class StudyOutcome:
    """What was measured, ready to be written and printed.

    Attributes:
        title: Heading of the page.
        summary: What was measured, in sentences.
        figures: All figures, in SI; anything that JSON can hold.
        sections: Tables, charts and sentences, in reading order.
        passed: Whether all that has a target reached it.
    """

    title: str
    summary: tuple[str, ...]
    figures: Any
    sections: tuple[Section, ...]
    passed: bool = True


def write_outcome(outcome: StudyOutcome, out: Path, *, numbered: bool = False) -> None:
    """Write `figures.json`, every chart as a picture, and `report.html` with all of it and the commit.

    Args:
        outcome: Of the study.
        out: Folder.
        numbered: Put a number before the names of pictures, which several of them then may share.
    """
    write_json(out / "figures.json", outcome.figures)
    charts = [block for section in outcome.sections for block in section.blocks if isinstance(block, Chart)]
    for number, chart in enumerate(charts):
        draw_png(chart, out / (f"{number:02d}-{chart.name}.png" if numbered else f"{chart.name}.png"))
    measured = format_measured(date.today(), find_commit())
    write_report(ReportPage(outcome.title, outcome.summary, outcome.sections, measured), out / "report.html")
