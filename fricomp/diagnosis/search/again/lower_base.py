"""A base that leaves less, found from where effects had led it."""

from __future__ import annotations

from ...effects.structure import N_BASE
from ...inputs.track import FloatArray
from ...joint.base_fit import fit_base
from ..preparation import Baseline
from ..search import SearchResult


def find_lower_base(baseline: Baseline, found: SearchResult) -> FloatArray | None:
    """Return base parameters with which the base alone leaves clearly less than it did; None where there are none.

    Its fit had ended in another valley. An effect leads out of that and gains by it, whatever it does itself: a delay
    of no length was named of a joint that lacked nothing. What leaves no less with its effects leads nowhere.

    Args:
        baseline: The base that was searched with.
        found: What the search found.
    """
    leading, clearly_less = found.leading, baseline.fit.cost - found.threshold
    if leading is None or leading.fit.cost >= clearly_less:
        return None
    fit = fit_base(baseline.problem, leading.fit.theta[:N_BASE], baseline.box)
    return fit.theta if fit.cost < clearly_less else None
