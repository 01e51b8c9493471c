"""The page on the second generator, in Markdown."""

from collections.abc import Sequence
from pathlib import Path

from ..kit.interval import KnownInterval
from ..kit.page import write_page as fill_page
from .effects import EFFECTS
from .figures import compute_figures
from .score import Score


def write_page(scores: Sequence[Score], page: Path, commits: Sequence[str], *, quick: bool = False) -> None:
    """Write the Markdown page.

    Args:
        scores: Of the cases.
        page: File.
        commits: At which they were measured.
        quick: The recordings are the short ones.
    """
    shown = {score.case.effect for score in scores}
    command = f"fricomp bench second-generator{' --quick' if quick else ''}"
    known = [(score, value) for score in scores for value in score.values if value.effect == score.case.effect]
    fill_page(
        "second_generator/page.md",
        page,
        seconds=f"{scores[0].case.duration:g}" if scores else "60",
        count=len(scores),
        commits=commits,
        command=command,
        name=page.name,
        figures=compute_figures(scores),
        effects=[[f"`{e.name}`", e.group, e.how] for e in EFFECTS.values() if e.name in shown],
        cases=[_list_case(score) for score in scores],
        parameters=[_list_parameter(score, value) for score, value in known],
        wrong=[
            [score.case.name, _explain(score), f"`{command} --only {score.case.name} --out runs/second`"]
            for score in scores
            if score.wrong
        ],
    )


def _list_case(score: Score) -> list[str]:
    right = "**no**" if score.wrong else "yes"
    named = ", ".join(map(_format_name, score.named, score.sets)) or "–"
    return [score.case.name, f"`{score.verdict}`", named, right, _format_errors(score), f"{score.seconds:.0f}"]


def _format_name(name: str, others: Sequence[str]) -> str:
    return f"`{name}`" + (f" ({', '.join(f'`{other}`' for other in others)})" if others else "")


def _format_errors(score: Score) -> str:
    if score.before is None or score.after is None or score.floor is None:
        return "–"
    return f"{score.before:.3g} → {score.after:.3g} ({score.floor:.2g})"


def _list_parameter(score: Score, value: KnownInterval) -> list[str]:
    found = f"{value.value:.4g} ({value.low:.4g} to {value.high:.4g})"
    return [score.case.name, value.parameter, f"{value.truth:.4g}", found, "yes" if value.covers else "**no**"]


def _explain(score: Score) -> str:
    """In words, what is wrong with an answer."""
    if score.error:
        return f"no answer: {score.error.splitlines()[-1].replace('|', '/')}"
    parts = [] if score.verdict_right else [f"`{score.verdict}` in place of `{'` or `'.join(score.expected)}`"]
    if score.false_names:
        parts.append("named " + ", ".join(f"`{name}`" for name in score.false_names))
    if score.hidden and not score.first_right:
        parts.append("not first" if score.found else "not found")
    return "; ".join(parts)
