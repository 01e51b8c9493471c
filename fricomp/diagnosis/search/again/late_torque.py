"""A torque that acts later than the base allows for, as the base alone tells it."""

from __future__ import annotations

from dataclasses import replace

from ...effects.structure import N_BASE
from ...joint.base import BASE_NAMES, is_at_earliest, unpack
from ...joint.base_fit import fit_base, is_loud
from ..explanation import Explanation
from ..preparation import Baseline
from ..settings import SEARCH

_DELAY = BASE_NAMES.index("delay")


def measure_late_torque(baseline: Baseline, chosen: Explanation | None = None) -> float:
    """Measure how long after its stamp the torque acts by the base [s]; 0 where its delay is not at the bound, nor that
    of the base with what was `chosen`, which may have bent it.

    A joint that moves slowly hardly shows a late torque beside its inertia: nothing but the base's delay tells of it.
    """
    fit, box = baseline.fit, baseline.box
    joints = [fit, *([] if chosen is None else [chosen.fit])]
    at_bound = [is_at_earliest(unpack(one.theta[:N_BASE]), float(box.lower[_DELAY])) for one in joints]
    if not is_loud(fit) or not all(at_bound):
        return 0.0
    lower, precision = box.lower.copy(), box.precision.copy()
    lower[_DELAY], precision[_DELAY] = -SEARCH.latest_torque, 0.0
    precision[:, _DELAY] = 0.0
    wider = replace(box, lower=lower, precision=precision)
    tried = []
    for delay in SEARCH.late_starts:
        start = fit.theta.copy()
        start[_DELAY] = -delay
        tried.append(fit_base(baseline.problem, start, wider))
    best = min(tried, key=lambda one: one.cost)
    return max(-float(best.theta[_DELAY]), 0.0) if best.cost < SEARCH.late_cost * fit.cost else 0.0
