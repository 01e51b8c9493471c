"""The joint that was found, as the first estimate of another search: a strong effect had bent the usual one far."""

from __future__ import annotations

import numpy as np

from ...effects.structure import N_BASE
from ...joint.base import BASE_NAMES, unpack
from ...joint.observer import Plant
from ...joint.solver import Fit
from ..preparation import Baseline
from ..search import SearchResult
from ..settings import SEARCH

_INERTIA = BASE_NAMES.index("log_inertia")


def find_far_joint(baseline: Baseline, found: SearchResult) -> Plant | None:
    """Return the joint of the best explanation where that covers most, its inertia is far from the first estimate, and
    more than noise is left; None elsewhere, and where a simulation says the inertia.

    The observer holds a joint of another inertia too loosely or too tightly, the velocities are those of another
    motion, and the inertia may end at the bound of its domain.

    Args:
        baseline: The base that was searched with.
        found: What the search found.
    """
    if found.best is None or found.best.coverage < SEARCH.most_covered or baseline.rigid is not None:
        return None
    if measure_left(baseline, found) <= SEARCH.something_left:
        return None
    plant = unpack(found.best.fit.theta[:N_BASE])
    is_far = abs(np.log(plant.inertia) - baseline.box.centre[_INERTIA]) > np.log(SEARCH.far_inertia)
    return plant if is_far and plant.level > 0.0 else None  # one without dry friction is bent itself


def measure_left(baseline: Baseline, found: SearchResult) -> float:
    """Measure what the best explanation, or else the base, leaves over the noise."""
    return baseline.measure_loudness(_choose_fit(baseline, found))


def measure_plain_left(baseline: Baseline, found: SearchResult) -> float:
    """Measure the torque that the best explanation, or else the base, leaves while the joint slides [N·m] or [N]."""
    return baseline.measure_plain(_choose_fit(baseline, found))


def _choose_fit(baseline: Baseline, found: SearchResult) -> Fit:
    return baseline.fit if found.best is None else found.best.fit
