"""What this recording cannot tell apart: effects that explain it as well as the one that was named."""

from __future__ import annotations

import numpy as np

from ..record.result import Distinguishability
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.screening import Screen, orthonormalise
from ..search.search import SearchResult
from .settings import ALIASES


def list_aliases(found: SearchResult, name: str) -> tuple[str, ...]:
    """Effects that could stand in the place of `name` in the best explanation."""
    best = found.best
    if best is None:
        return ()
    others = set(best.names) - {name}
    # Where the best one leaves nothing its form is right, and a worse rival's is not.
    least = best.gain - max(ALIASES.close, best.left, found.explainable_null)
    rivals = [rival for rival in list_alternatives(found) if rival.gain > least and others <= set(rival.names)]
    return tuple(sorted({next(iter(set(rival.names) - others)) for rival in rivals}))


def list_printed_rivals(found: SearchResult) -> list[Explanation]:
    """Rivals with an effect that is told as what a named one cannot be told from, best first."""
    own = found.best.names if found.best is not None else ()
    others = {alias for name in own for alias in list_aliases(found, name)}
    return [rival for rival in list_alternatives(found) if others & (set(rival.names) - set(own))]


def list_alternatives(found: SearchResult) -> list[Explanation]:
    """Explanations by other effects, as many of them, that fit about as well as the best one, best first."""
    best = found.best
    if best is None:
        return []
    alike = (e for e in found.explanations if len(e.names) == len(best.names) and e.names != best.names)
    return [rival for rival in alike if not rival.refused and is_as_good(rival, best)]


def is_as_good(rival: Explanation, best: Explanation) -> bool:
    """Whether an explanation fits about as well as the best one."""
    return rival.gain > best.gain - max(ALIASES.close, ALIASES.form * best.gain)


def measure_late_rival(found: SearchResult) -> float:
    """Time by which the torque acts late, where that fits about as well as the low pass that was found [s]; else 0.

    The search looks for a reading that is late, and meets a torque that acts late as one that would be read before.
    """
    best, late = found.best, ("torque_delay",)
    if best is None or best.names != ("drive_lag",):
        return 0.0
    rivals = [one for one in found.explanations if one.names == late and is_as_good(one, best)]
    return max((-one.values[late[0]]["delay"] for one in rivals), default=0.0)


def compare_effects(baseline: Baseline, screened: Screen) -> Distinguishability:
    """One minus R² of each effect by each other, after the base is refitted."""
    best = screened.select_best()
    names = tuple(sorted(best))
    spans = [best[name].span for name in names]
    matrix = [[_measure_distance(a, b) for b in spans] for a in spans]
    return Distinguishability(names, matrix)


def _measure_distance(a: np.ndarray, b: np.ndarray) -> float:
    if a.shape[1] == 0 or b.shape[1] == 0:
        return 1.0
    overlap = float(np.sum((orthonormalise(b).T @ a) ** 2)) / a.shape[1]
    return float(np.clip(1.0 - overlap, 0.0, 1.0))
