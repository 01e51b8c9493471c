"""Scores that no case is behind, to look at what is made of them."""

from dataclasses import fields
from typing import Any

from fricomp.sim_bench.studies.proof import Score

_EMPTY: dict[str, Any] = {"str": "", "int": 0, "float": 0.0, "bool": False}
_EMPTY |= dict.fromkeys(("tuple[KnownInterval, ...]", "tuple[Belief, ...]"), ())


def score_of(group: str = "single", **given: Any) -> Score:
    """A score with these fields; the rest is empty, and the answer consistent."""
    known = {"case": "case-1", "excitation": "rich", "core": "lugre", "noise": "white", "strength": "2"}
    known["verdict"] = "consistent"
    empty = {field.name: _EMPTY[str(field.type)] for field in fields(Score)}
    return Score(**empty | known | {"group": group} | given)
