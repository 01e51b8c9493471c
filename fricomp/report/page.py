"""A report page: what was found in plain sentences first, then sections of charts, tables and text, in one file."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from fricomp.errors import ParameterError
from fricomp.extras import needing
from fricomp.report.chart import Chart
from fricomp.report.interactive import draw_interactive, plotly_script
from fricomp.whole_file import write_whole

__all__ = ["Check", "Outcome", "ReportPage", "Section", "Table", "describe_chart", "write_report"]


@dataclass(frozen=True)
class Table:
    """Rows of text; numbers are formatted by whoever knows their unit.

    Attributes:
        columns: Headings, with units.
        rows: One entry a column; a column of cells that begin with a digit or a sign is set flush right.
        caption: What it shows; empty for none.
        links: Where the first cell of each row leads, by that cell; paths from the folder of the page.
        filtered: Whether the reader can look for rows by a word.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    links: Mapping[str, str] = field(default_factory=dict)
    filtered: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ParameterError(f"a table of {len(self.columns)} columns has a row of {len(row)}: {row}")

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column holds numbers, with dashes or nothing where there are none."""
        return tuple(
            any(map(_is_numeric, cells)) and all(_is_numeric(cell) or cell in ("", "–") for cell in cells)
            for cells in zip(*self.rows, strict=True)
        ) or (False,) * len(self.columns)


Outcome = Literal["passed", "warning", "failed", "note"]


@dataclass(frozen=True)
class Check:
    """One thing that was looked at.

    Attributes:
        name: What was looked at.
        outcome: `passed`, `warning`, `failed`, or `note` where there is no verdict.
        detail: What was found, with values.
    """

    name: str
    outcome: Outcome
    detail: str


Block = str | Chart | Table | Check
"""A string is a paragraph."""


@dataclass(frozen=True, eq=False)
class Section:
    """A heading and what stands under it, in order.

    Attributes:
        title: Heading.
        blocks: Paragraphs (strings), charts, tables and checks.
        folded: Whether the reader opens it on demand, such as raw settings.
    """

    title: str
    blocks: tuple[Block, ...]
    folded: bool = False


@dataclass(frozen=True, eq=False)
class ReportPage:
    """The whole page.

    Attributes:
        title: Heading.
        summary: Plain sentences: the result, and what to do about it.
        sections: In reading order.
        subtitle: Joint, date, and the like.
        facts: Name to value: a line of key figures below the summary.
        outcome: What the first card looks like: `failed` where the result is not to be used.
        verdict: A word or two above the summary, such as `Not usable`; empty for none.
    """

    title: str
    summary: tuple[str, ...]
    sections: tuple[Section, ...]
    subtitle: str = ""
    facts: dict[str, str] = field(default_factory=dict)
    outcome: Outcome = "note"
    verdict: str = ""


def write_report(page: ReportPage, path: str | os.PathLike[str]) -> Path:
    """Write `page` as one HTML file that opens without a network, whole or not at all.

    Returns:
        The path.

    Raises:
        MissingExtraError: jinja2 or plotly is not installed.
        OutputError: The file cannot be written.
    """
    with needing("jinja2", "report"):
        from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
    environment = Environment(
        loader=PackageLoader("fricomp.report", "."),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    sections = [
        {"title": section.title, "folded": section.folded, "blocks": [_render_block(block) for block in section.blocks]}
        for section in page.sections
    ]
    has_charts = any(isinstance(block, Chart) for section in page.sections for block in section.blocks)
    script = plotly_script() if has_charts else ""
    html = environment.get_template("page.html").render(page=page, sections=sections, plotly_script=script)
    target = Path(path)
    write_whole(target, html)
    return target


def _render_block(block: Block) -> dict[str, Any]:
    match block:
        case str():
            return {"kind": "text", "text": block}
        case Chart():
            return {
                "kind": "chart",
                "chart": block,
                "html": draw_interactive(block),
                "alternative": describe_chart(block),
            }
        case Table():
            return {"kind": "table", "table": block}
        case Check():
            return {"kind": "check", "check": block}


def describe_chart(chart: Chart) -> str:
    """A chart in words, for whoever cannot see it: what each panel shows over what, and the caption."""
    shown = []
    for panel in chart.panels:
        labels = [label for mark in panel.marks if (label := getattr(mark, "label", ""))]
        over = f"{panel.y_label} over {panel.x_label}" if panel.x_label and panel.y_label else panel.y_label
        named = f"{panel.title}: {over}" if panel.title else over
        shown.append(f"{named} ({', '.join(dict.fromkeys(labels))})" if labels else named)
    return ". ".join(part.rstrip(".") for part in (chart.title, *shown, chart.caption) if part) + "."


def _is_numeric(cell: str) -> bool:
    return bool(cell) and (cell[0].isdigit() or cell[0] in "+-−±<≤≥")
