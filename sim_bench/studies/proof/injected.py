"""The plan of effects injected into real recordings: first the recordings as they are, then one effect at a time."""

from collections.abc import Iterator, Sequence

from fricomp.recording import find_public_data

from ..real import INJECTABLE, REAL_CASES, InjectedSpec
from .plan import PlannedCase
from .score import Score

_STRENGTHS = ("5", "2", "1")
"""Wanted strengths, the clear ones first, so that a short run has seen every effect once."""


def plan_bare() -> list[PlannedCase]:
    """The recordings whose data are here, with nothing injected."""
    sets = {case.name: case.sources[0].partition("/")[0] for case in REAL_CASES}
    found = [name for name in INJECTABLE if find_public_data(sets[name]) is not None]
    return [PlannedCase("injected_null", InjectedSpec(name)) for name in found]


def plan_injected(bare: Sequence[Score], seeds: Iterator[int]) -> list[PlannedCase]:
    """Effects in turn, every recording in turn, at three strengths; interleaved, so that any beginning is fair.

    What the diagnosis says of a recording as it is counts as known there and is not injected. Recordings that it
    refuses are left out.

    Args:
        bare: Scores of `plan_bare`.
        seeds: One is taken for each case.
    """
    answers = {score.excitation: score for score in bare if score.verdict not in ("failed", "bad_data")}
    known = {name: _list_names(score) for name, score in answers.items()}
    planned = []
    for strength in _STRENGTHS:
        for turn in range(max(map(len, INJECTABLE.values()))):
            for name, score in answers.items():
                effects = [effect for effect in INJECTABLE[name] if effect not in known[name]]
                if turn < len(effects):
                    spec = InjectedSpec(name, effects[turn], strength, next(seeds), known[name], score.verdict)
                    planned.append(PlannedCase("injected", spec))
    return planned


def _list_names(score: Score) -> tuple[str, ...]:
    """Everything that was named or could not be told from a name."""
    return tuple(
        sorted({name for part in (score.named, score.sets) for name in part.replace("|", "+").split("+")} - {""})
    )
