"""A curve over speed, fitted from curves of the base that have not been bent into its shape."""

from __future__ import annotations

import numpy as np

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Structure
from ..joint.base import BASE_NAMES, BODY_AND_CURVES, pack
from ..joint.weak_form import estimate_beside
from .explanation import Explanation
from .preparation import Baseline
from .refit import fit_from

_FRICTION = slice(BASE_NAMES.index("offset"), BODY_AND_CURVES)


def fit_straightened(baseline: Baseline, best: Explanation) -> list[Explanation]:
    """Fit an explanation again, with the friction of its joint estimated anew beside its curves over speed.

    Alone, the base bends its Stribeck curves into the shape of drag: a Stribeck velocity that has run off leads back
    uphill, and what trades against it leaves the size of the drag open.

    Args:
        baseline: The base fitted to the recordings.
        best: What was found; nothing is fitted where it has no such curve.
    """
    curves = [one for one in best.settled if EFFECTS[one.name].compute_curve(best.values[one.name], 1.0) is not None]
    if not curves:
        return []
    drawn = Structure(best.structure.contexts, tuple(curves))
    at = np.concatenate([best.fit.theta[:N_BASE], drawn.build_start()])
    drawn_along = zip(drawn.compute_contributions(at), drawn.contexts, strict=True)
    added = [one.additive + np.zeros_like(context.velocity) for one, context in drawn_along]
    width = baseline.problem.observer.width
    _, _, plant = estimate_beside(baseline.problem.tracks, [added], width=width, known=baseline.rigid)
    start = best.fit.theta[:N_BASE].copy()
    start[_FRICTION] = pack(plant)[_FRICTION]
    structure = best.settled_structure.move_to(best.structure.move_contexts(best.fit.theta))
    return fit_from(baseline, [(structure, start)], baseline.box)
