"""The page of a proof: figures, their causes and parts, power and wrong answers as Markdown with charts beside it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from fricomp.report import draw_png

from .by_effect import format_coverage, format_places
from .causes import format_causes, read_causes
from .charts import draw_confusion, draw_power
from .figure import Figure
from .judging import is_wrong
from .page_text import CLEAR, INJECTED, INTRODUCTION, LIMITS, NULLS
from .plan import NULLS as NULL_GROUPS
from .power import PowerPoint, compute_confusion, compute_power
from .score import Score
from .splits import format_splits
from .summary import compute_figures
from .wrong import format_misses, format_wrong

__all__ = ["write_page"]

_NO_CASE = "–"  # begins the value of a figure without one


def write_page(
    scores: Sequence[Score],
    page: Path,
    *,
    title: str,
    reproduce: str,
    baselines: str = "",
    earlier: str = "",
    gaps: str = "",
    clear: bool = False,
) -> None:
    """Write `page` and the charts in the folder of its name beside it.

    Args:
        scores: Of the cases.
        page: Markdown file.
        title: Which run this is, in one sentence.
        reproduce: Command that makes it again.
        baselines: Markdown of the comparison with other methods; empty for none.
        earlier: Markdown of the scored runs before this one; empty for none.
        gaps: Markdown of the gaps closed, measured by second diagnoses; empty for none.
        clear: Whether the cases are every effect once, clear.
    """
    groups = {score.group for score in scores}
    injected, only_nulls = any(group.startswith("injected") for group in groups), groups <= set(NULL_GROUPS)
    folder = page.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    figures = compute_figures(scores)
    sections = [
        INJECTED if injected else NULLS if only_nulls else CLEAR if clear else INTRODUCTION,
        f"## Figures\n\n{title}\n\n    {reproduce}\n\n{_figure_table(figures)}",
        format_causes(figures, read_causes(folder)),
        f"## Cases\n\n{_group_table(scores)}",
        "" if injected else format_splits(scores),
        *_charts(scores, folder),
        format_coverage(scores),
        format_places(scores),
        gaps,
        earlier,
        baselines,
        _answers_as_they_are(scores) if injected else "" if only_nulls or clear else LIMITS,
        format_wrong(scores),
        format_misses(scores),
    ]
    page.write_text("\n\n".join(part for each in sections if (part := each.strip())) + "\n", encoding="utf-8")


def _charts(scores: Sequence[Score], folder: Path) -> list[str]:
    """Sections with the charts, which are drawn in the folder beside the page."""
    sections, power, confusion = [], compute_power(scores), compute_confusion(scores)
    if power:
        draw_png(draw_power(power), folder / "power.png")
        link = f"![Power against strength]({folder.name}/power.png)"
        sections.append(f"## Power\n\n{link}\n\n{_power_table(power)}")
    if confusion:
        draw_png(draw_confusion(confusion), folder / "confusion.png")
        link = f"![Confusion matrix]({folder.name}/confusion.png)"
        sections.append(f"## Which answer came first, from ENR 0.5\n\n{link}")
    return sections


def _figure_table(figures: Sequence[Figure]) -> str:
    rows = [
        f"| {f.name} | {f.target} | {f.value} | {f.standing.replace('no', '**no**')} |"
        for f in figures
        if not f.value.startswith(_NO_CASE)
    ]
    return "\n".join(["| figure | target | measured (95 % interval) | reached |", "|---|---|---|---|", *rows])


def _group_table(scores: Sequence[Score]) -> str:
    groups = Counter(score.group for score in scores)
    wrong = Counter(score.group for score in scores if is_wrong(score))
    rows = [f"| {group} | {count} | {wrong[group]} |" for group, count in groups.most_common()]
    return "\n".join(["| group | cases | wrong answers |", "|---|---|---|", *rows])


def _answers_as_they_are(scores: Sequence[Score]) -> str:
    rows = [f"| {s.excitation} | {s.verdict} | {s.named or '–'} |" for s in scores if s.group == "injected_null"]
    head = ["## The recordings as they are", "", "| recording | verdict | named |", "|---|---|---|"]
    return "\n".join([*head, *rows])


def _power_table(points: Sequence[PowerPoint]) -> str:
    rows = [f"| {p.band} | {p.enr:.2f} | {p.detected} | {p.named} | {p.oracle:.1%} |" for p in points]
    head = ["| strength reached | median | called missing | right name first | oracle |", "|---|---|---|---|---|"]
    return "\n".join([*head, *rows])
