"""The page of a proof: figures, their causes and parts, power and wrong answers, with charts beside it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fricomp.report import draw_png

from ..kit.figure import Figure
from ..kit.page import fill_template
from ..kit.page import write_page as fill_page
from . import parts
from .causes import explain_misses, read_causes
from .charts import draw_confusion, draw_power
from .judging import is_wrong
from .plan import NULLS
from .power import compute_confusion, compute_power
from .score import Score
from .summary import compute_figures

_NO_CASE = "–"
"""Begins the value of a figure without a case."""

_FEWEST = 2
"""Strengths, or effects, that make a chart."""


def write_page(
    scores: Sequence[Score],
    page: Path,
    *,
    title: str,
    reproduce: str,
    baselines: str = "",
    gaps: str = "",
    clear: bool = False,
) -> None:
    """Write `page`, and in the folder of its name beside it the charts and the details of a whole proof.

    Args:
        scores: Of the cases.
        page: Markdown file.
        title: Which run this is, in one sentence.
        reproduce: Command that makes it again.
        baselines: Markdown of the comparison with other methods; empty for none.
        gaps: Markdown of the gaps closed, measured by second diagnoses; empty for none.
        clear: Whether the cases are every effect once, clear.
    """
    groups = {score.group for score in scores}
    injected = any(group.startswith("injected") for group in groups)
    kind = "injected" if injected else "nulls" if groups <= set(NULLS) else "clear" if clear else "introduction"
    folder = page.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    figures = compute_figures(scores)
    values = {
        "kind": kind,
        "title": title,
        "reproduce": reproduce,
        "folder": folder.name,
        "figures": _list_figures(figures),
        "power": [] if clear else _draw_power(scores, folder),
        "confused": _draw_confusion(scores, folder),
        "causes": explain_misses(figures, read_causes(folder)),
        "gaps": gaps.strip(),
        "baselines": baselines.strip(),
        "bare": [[s.excitation, s.verdict, s.named or "–"] for s in scores if s.group == "injected_null"],
        **_split(scores),
    }
    fill_page("proof/page.md", page, **values)
    if kind == "introduction":
        fill_page("proof/details.md", folder / "details.md", **values)


def _split(scores: Sequence[Score]) -> dict[str, Any]:
    return {
        "count": len(scores),
        "groups": parts.list_groups(scores),
        "recordings": parts.list_recordings(scores),
        "nothing_by_axis": parts.list_nothing(scores),
        "single_by_axis": parts.list_single(scores),
        "parameters": parts.list_coverage(scores),
        "places": parts.list_places(scores),
        "wrong": parts.list_wrong(scores),
        "misses": parts.list_misses(scores),
    }


def format_failures(scores: Sequence[Score]) -> str:
    """The wrong answers as text, those with nothing concealed first, each with the command that makes its case."""
    wrong = sorted((score for score in scores if is_wrong(score)), key=lambda s: (s.group, s.truth, -s.enr))
    return fill_template("proof/failures.md", wrong=wrong, count=len(scores))


def _list_figures(figures: Sequence[Figure[Score]]) -> list[list[str]]:
    rows, topic = [], ""
    for figure in (each for each in figures if not each.value.startswith(_NO_CASE)):
        rows += [[f"**{figure.topic}**", "", "", ""]] if figure.topic != topic else []
        rows.append([figure.name, figure.target, figure.value, figure.standing.replace("no", "**no**")])
        topic = figure.topic
    return rows


def _draw_power(scores: Sequence[Score], folder: Path) -> list[list[str]]:
    """Draw the chart of the power and list its points; nothing where there is one strength alone."""
    points = compute_power(scores)
    if len(points) < _FEWEST:
        return []
    draw_png(draw_power(points), folder / "power.png")
    return [[p.band, f"{p.enr:.2f}", str(p.detected), str(p.named), f"{p.oracle:.1%}"] for p in points]


def _draw_confusion(scores: Sequence[Score], folder: Path) -> bool:
    """Draw the confusion matrix, and say so; nothing where it has one row."""
    confusion = compute_confusion(scores)
    if len(confusion) < _FEWEST:
        return False
    draw_png(draw_confusion(confusion), folder / "confusion.png")
    return True
