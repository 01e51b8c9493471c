"""Whether probabilities hold: answers given with probability p must be right in p of the cases."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .statistics import compute_share

_NOTHING, _UNKNOWN = "nothing", "unknown"  # the keys of `probability` that are no names


@dataclass(frozen=True)
class Belief:
    """One probability of an answer, beside what is true.

    Attributes:
        name: Of an effect, "nothing" or "unknown".
        probability: As the diagnosis gave it [1].
        right: Whether it is so.
        named: Whether it was named.
    """

    name: str
    probability: float
    right: bool
    named: bool = False


def list_beliefs(said: Mapping[str, Any], right: Collection[str], expected: str) -> tuple[Belief, ...]:
    """List the probabilities of an answer.

    Args:
        said: The content of `diagnosis.json`.
        right: Names that are right, those of parameters that are off included.
        expected: The right verdict.
    """
    truth = {_NOTHING: expected == "consistent" and not right, _UNKNOWN: expected == "unknown_physics"}
    named = {each["name"] for each in said["effects"]}
    return tuple(
        Belief(name, float(value), truth.get(name, name in right), name in named)
        for name, value in (said.get("probability") or {}).items()
    )


def compute_brier(beliefs: Sequence[Belief]) -> float:
    """Mean squared distance of the probabilities from what is true, 0 for a prophet and 0.25 for a coin [brier1950]."""
    return float(np.mean([(one.probability - one.right) ** 2 for one in beliefs])) if beliefs else float("nan")


def describe_beliefs(beliefs: Sequence[Belief], *, named: bool) -> list[tuple[str, str]]:
    """Whether the probabilities hold, by names and values of figures: their Brier score, and how often each tenth of
    them was right; none where there are no probabilities.

    Args:
        beliefs: Of all cases.
        named: Whether the names that were given have a score of their own.
    """
    groups = {"all probabilities (0.25 is a coin's)": beliefs}
    groups |= {"the names that were given": [one for one in beliefs if one.named]} if named else {}
    rows = [(f"Brier score of {name}", f"{compute_brier(some):.3f} ({len(some)})") for name, some in groups.items()]
    tenths = [(f"right, of those with probability {tenth}", share) for tenth, share in tabulate_beliefs(beliefs)]
    return [*rows, *tenths] if beliefs else []


def tabulate_beliefs(beliefs: Sequence[Belief]) -> list[tuple[str, str]]:
    """Each tenth of the probabilities in which there are some, and how often they were right."""
    tenths = [min(int(10.0 * one.probability), 9) for one in beliefs]
    rows = []
    for tenth in sorted(set(tenths)):
        some = [one.right for one, its in zip(beliefs, tenths, strict=True) if its == tenth]
        rows.append((f"{tenth / 10:.1f} to {(tenth + 1) / 10:.1f}", str(compute_share(sum(some), len(some)))))
    return rows
