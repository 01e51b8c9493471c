"""Scores that no case is behind, to look at what is made of them."""

from typing import Any, get_type_hints

from fricomp.sim_bench.studies.proof import Score

_EMPTY: dict[type, Any] = {str: "", int: 0, float: 0.0, bool: False}


def score_of(group: str = "single", **given: Any) -> Score:
    """A score with these fields; the rest is empty, and the answer consistent."""
    known = {"case": "case-1", "excitation": "rich", "core": "lugre", "noise": "white", "strength": "2"}
    known["verdict"] = "consistent"
    empty = {name: _EMPTY.get(kind, ()) for name, kind in get_type_hints(Score).items()}
    return Score(**empty | known | {"group": group} | given)
