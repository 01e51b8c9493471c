"""The page on sealed arms, in Markdown."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..kit.page import write_page as fill_page
from ..proof.settings import RunSettings
from .figures import compute_figures, list_concealed
from .score import CLEAR, ArmScore, NamedEffect, TrueEffect


def write_page(scores: Sequence[ArmScore], settings: RunSettings, page: Path, command: str) -> None:
    """Write the page.

    Args:
        scores: Of the arms.
        settings: Of the run.
        page: File.
        command: That made it.
    """
    fill_page(
        "arms/page.md",
        page,
        count=len(scores),
        planned=settings.cases,
        scored=settings.scored,
        commits=settings.commits,
        command=command,
        clear=CLEAR,
        figures=[[each.name, each.target, each.value, each.standing] for each in compute_figures(scores)],
        effects=_list_effects(scores),
        links=_list_links(scores),
        misses=_list_misses(scores),
        falsehoods=_list_falsehoods(scores),
    )


def _list_effects(scores: Sequence[ArmScore]) -> list[list[str]]:
    """Effect by effect: how many, found, exact, clear ones only."""
    clear = list_concealed(scores, CLEAR)
    rows = []
    for name in sorted({one.effect.name for one in list_concealed(scores)}):
        own = [one for one in clear if one.effect.name == name]
        weak = sum(one.effect.name == name for one in list_concealed(scores)) - len(own)
        found = sum(one.score.is_found(one.effect) for one in own)
        exact = sum(one.score.is_exact(one.effect) for one in own)
        rows.append([f"`{name}`", str(len(own)), str(found), str(exact), str(weak)])
    return rows


def _list_links(scores: Sequence[ArmScore]) -> list[list[str]]:
    """By number of a link: how many are determined, and in how many the interval holds the truth."""
    rows = []
    for name in ("mass", "x", "y", "z"):
        known = [each for score in scores for each in score.links if each.parameter == name]
        held = sum(each.covers for each in known)
        error = np.median([abs(each.value - each.truth) for each in known]) if known else float("nan")
        unit = "kg" if name == "mass" else "kg·m"
        rows.append([name, str(len(known)), f"{held / max(len(known), 1):.1%}", f"{error:.3g} {unit}"])
    return rows


def _list_misses(scores: Sequence[ArmScore]) -> list[list[str]]:
    return [
        [str(score.seed), effect.joint, f"`{effect.name}`", f"{effect.enr:.2g}", explain_miss(score, effect)]
        for score, effect in list_concealed(scores, CLEAR)
        if not score.is_exact(effect)
    ]


def explain_miss(score: ArmScore, effect: TrueEffect) -> str:
    """Why a clear effect was not named exactly, in a few words."""
    if score.error:
        return f"no answer: {score.error.splitlines()[-1].replace('|', '/')}"
    said = [one for one in score.named if one.joint == effect.joint]
    right = [one for one in said if one.means(effect)]
    others = [one for one in said if not any(one.means(each) for each in score.truth)]
    if right:
        return "named, with " + _format(others) if others else "named; another one in this joint was not"
    return "taken for " + _format(said) if said else "nothing named in the joint"


def _list_falsehoods(scores: Sequence[ArmScore]) -> list[list[str]]:
    return [[str(score.seed), one.joint, _format([one]), _tell(score)] for score in scores for one in score.false_names]


def _tell(score: ArmScore) -> str:
    return ", ".join(f"{one.joint} `{one.name}` ({one.enr:.2g})" for one in score.truth) or "–"


def _format(named: Sequence[NamedEffect]) -> str:
    return ", ".join(f"`{one.name}`" for one in named)
