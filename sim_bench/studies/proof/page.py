"""The page of a proof: figures, their causes and parts, power and wrong answers as Markdown with charts beside it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from fricomp.report import draw_png, format_markdown_table

from .by_effect import format_coverage, format_places
from .causes import format_causes, read_causes
from .charts import draw_confusion, draw_power
from .figure import WEAK, Figure
from .judging import is_wrong
from .page_text import CLEAR, HOW_A_RUN_GOES, INJECTED, INTRODUCTION, LIMITS, NULLS
from .plan import NULLS as NULL_GROUPS
from .power import PowerPoint, compute_confusion, compute_power
from .score import Score
from .splits import format_splits
from .summary import compute_figures
from .wrong import format_misses, format_wrong

__all__ = ["DETAILS", "write_page"]

DETAILS = "details.md"
"""Second page of a proof, in the folder beside the first."""

_NO_CASE = "–"  # begins the value of a figure without one
_FEWEST = 2  # strengths, or effects, that make a chart


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
    """Write `page`, and in the folder of its name beside it the charts and the details of a whole proof.

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
    whole = not (injected or only_nulls or clear)
    folder = page.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    figures = compute_figures(scores)
    main = [
        INTRODUCTION if whole else INJECTED if injected else NULLS if only_nulls else CLEAR,
        f"## Figures\n\n{title}\n\n    {reproduce}\n\n{_figure_table(figures)}",
        *([] if clear else _power(scores, folder)),
        *_confusion(scores, folder),
        format_causes(figures, read_causes(folder)),
        gaps,
        baselines,
        _answers_as_they_are(scores) if injected else LIMITS if whole else "",
    ]
    details = [
        f"## Cases\n\n{_group_table(scores)}",
        _recordings(scores) if injected else format_splits(scores),
        format_coverage(scores),
        format_places(scores),
        format_wrong(scores),
        format_misses(scores),
        earlier,
    ]
    if not whole:
        _write(page, [*main, *details])
        return
    beside = folder / DETAILS
    _write(page, [*main, f"Cases, parts and wrong answers one by one: [details]({folder.name}/{DETAILS})."])
    _write(beside, [f"# Details of the proof on concealed cases\n\n{title}", HOW_A_RUN_GOES, *details])


def _write(page: Path, sections: Sequence[str]) -> None:
    page.write_text("\n\n".join(part for each in sections if (part := each.strip())) + "\n", encoding="utf-8")


def _power(scores: Sequence[Score], folder: Path) -> list[str]:
    """The section on power, whose chart is drawn beside the page; none of one strength."""
    power = compute_power(scores)
    if len(power) < _FEWEST:
        return []
    draw_png(draw_power(power), folder / "power.png")
    return [f"## Power\n\n![Power against strength]({folder.name}/power.png)\n\n{_power_table(power)}"]


def _confusion(scores: Sequence[Score], folder: Path) -> list[str]:
    """The section with the confusion matrix, which is drawn beside the page; none of one row."""
    confusion = compute_confusion(scores)
    if len(confusion) < _FEWEST:
        return []
    draw_png(draw_confusion(confusion), folder / "confusion.png")
    link = f"![Confusion matrix]({folder.name}/confusion.png)"
    return [f"## Which answer came first, from ENR 0.5\n\n{link}"]


def _figure_table(figures: Sequence[Figure]) -> str:
    rows, topic = [], ""
    for figure in (each for each in figures if not each.value.startswith(_NO_CASE)):
        rows += [[f"**{figure.topic}**", "", "", ""]] if figure.topic != topic else []
        rows.append([figure.name, figure.target, figure.value, figure.standing.replace("no", "**no**")])
        topic = figure.topic
    return format_markdown_table(["figure", "target", "measured (95 % interval)", "reached"], rows)


def _group_table(scores: Sequence[Score]) -> str:
    groups = Counter(score.group for score in scores)
    wrong = Counter(score.group for score in scores if is_wrong(score))
    rows = [[group, str(count), str(wrong[group])] for group, count in groups.most_common()]
    return format_markdown_table(["group", "cases", "wrong answers"], rows)


def _recordings(scores: Sequence[Score]) -> str:
    """Right names in each recording and of each effect, from ENR 1."""
    strong = [score for score in scores if score.group == "injected" and score.enr >= WEAK]
    keys: dict[str, Callable[[Score], str]] = {"recording": lambda s: s.excitation, "effect": lambda s: s.truth}
    rows = []
    for what, key in keys.items():
        for value in sorted(set(map(key, strong))):
            some = [score for score in strong if key(score) == value]
            hits = (sum(s.top_right for s in some), sum(s.in_set for s in some))
            rows.append([what, value, *(f"{hit} of {len(some)}" for hit in hits)])
    table = format_markdown_table(["", "", "right name first", "printed set holds it"], rows)
    return f"## By recording and effect, from ENR 1\n\n{table}" if rows else ""


def _answers_as_they_are(scores: Sequence[Score]) -> str:
    rows = [[s.excitation, s.verdict, s.named or "–"] for s in scores if s.group == "injected_null"]
    return f"## The recordings as they are\n\n{format_markdown_table(['recording', 'verdict', 'named'], rows)}"


def _power_table(points: Sequence[PowerPoint]) -> str:
    rows = [[p.band, f"{p.enr:.2f}", str(p.detected), str(p.named), f"{p.oracle:.1%}"] for p in points]
    return format_markdown_table(["strength reached", "median", "called missing", "right name first", "oracle"], rows)
