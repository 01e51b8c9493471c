"""Friction that creeps, seen only beside the effects that bend the base."""

from __future__ import annotations

from collections.abc import Sequence

from ...effects.structure import N_BASE, Structure
from ...inputs.track import FloatArray
from ...joint.base import BASE_NAMES, is_at_earliest, unpack
from ...joint.base_fit import fit_creep, is_loud, propose_creep_starts
from ...joint.race import Entry, Race
from ...joint.solver import Box
from ..explanation import Explanation
from ..preparation import Baseline, may_creep
from ..refit import fit_from
from ..search import SearchResult
from ..settings import SEARCH
from .late_joint import measure_left

_CREEP, _DELAY = BASE_NAMES.index("creep_velocity"), BASE_NAMES.index("delay")


def does_creep(baseline: Baseline) -> bool:
    """Whether the friction of the base creeps."""
    return float(baseline.fit.theta[_CREEP]) > 0.0


def find_late_creep(baseline: Baseline, found: SearchResult) -> Explanation | None:
    """Find the best explanation, or the strongest of its effects alone, with friction that creeps, where that leaves
    clearly less than a bristle; None elsewhere.

    A strong effect, such as a ripple as large as the friction, hides from the base alone what its friction does. What a
    bristle cannot do then, a power law of the speed draws, a drag or a transmission that gives way: beside those,
    nothing may be left for the creep to explain.

    Args:
        baseline: The base that was searched with.
        found: What the search found.
    """
    best = found.leading
    if best is None or does_creep(baseline) or not may_creep(baseline.problem.tracks):
        return None
    residual = best.fit.residual
    if found.best is None and float(residual @ residual) < SEARCH.late_creep_loud**2 * residual.size:
        return None
    alone = [e for e in found.explanations if len(e.names) == 1 and set(e.names) < set(best.names) and not e.refused]
    tried, worth = [best, *alone[:1]], SEARCH.late_creep_cost * best.fit.cost  # sorted by what they gain
    fitted = _fit_creeping(baseline, tried, Race(best.fit.cost, worth))
    least = min(fitted, key=lambda one: one.fit.cost)
    return least if least.fit.cost < worth else None


def propose_creep(baseline: Baseline, found: SearchResult) -> FloatArray | None:
    """Propose base parameters with friction that creeps where a loud base takes the torque as early as it may, shape
    (N_BASE,); None elsewhere, and where one effect leaves noise alone beside it.

    Friction that creeps turns over ahead of one that holds. A strong effect may keep both the base and what was found
    beside it in a valley from which no creep is in sight, of which that early torque is left.

    Args:
        baseline: The base that was searched with.
        found: What the search found.
    """
    early = is_at_earliest(unpack(baseline.fit.theta), float(baseline.box.lower[_DELAY]))
    if not early or not is_loud(baseline.fit) or does_creep(baseline) or not may_creep(baseline.problem.tracks):
        return None
    if found.best is not None and len(found.best.names) == 1 and measure_left(baseline, found) < SEARCH.something_left:
        return None
    tried = fit_creep(baseline.problem, baseline.fit, baseline.box)
    return None if tried is None else tried[0].theta


def _fit_creeping(baseline: Baseline, explanations: Sequence[Explanation], race: Race) -> list[Explanation]:
    """The same effects beside friction that creeps, from each of its starts, as long as they may win the race."""
    wanted, boxes = list[tuple[Structure, FloatArray]](), list[Box]()
    for one in explanations:
        structure = Structure(one.structure.contexts, one.settled)
        for start, box in propose_creep_starts(one.fit.theta[:N_BASE], baseline.box):
            wanted.append((structure, start))
            boxes.append(box)
    return fit_from(baseline, wanted, boxes, entry=Entry(race, hurried=True))
