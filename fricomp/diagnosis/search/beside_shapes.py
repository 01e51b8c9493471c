"""Fits of effects that bend the base far, from the joint as it is beside their shape."""

from __future__ import annotations

import numpy as np

from fricomp.errors import DiagnosisError

from ..effects import EFFECTS, Effect
from ..effects.structure import Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.base import BODY_AND_CURVES, pack
from ..joint.weak_form import estimate_beside
from .explanation import Explanation
from .preparation import Baseline
from .refit import fit_from


def fit_beside_shapes(baseline: Baseline) -> list[Explanation]:
    """Fit each effect that has such shapes from the joint that is estimated beside the one that suits best.

    The base takes a strong stop for gravity, ten times the true one, and a fit that starts there may end as a torque
    that saturates.
    """
    contexts = baseline.structure.contexts
    usable = [effect for effect in EFFECTS.values() if effect.find_obstacle(contexts) is None]
    starts = [start for effect in usable if (start := _find_start(baseline, effect)) is not None]
    return fit_from(baseline, starts, baseline.box)


def _find_start(baseline: Baseline, effect: Effect) -> tuple[Structure, FloatArray] | None:
    """The effect in its best shape and the joint beside it; None where it has no shapes, or none that fits."""
    contexts = baseline.structure.contexts
    shapes = effect.propose_shapes(contexts)
    if not shapes:
        return None
    along = [[np.asarray(effect.compute_contribution(one, values).additive) for one in contexts] for values in shapes]
    width = baseline.problem.observer.width
    try:
        best, size, plant = estimate_beside(baseline.problem.tracks, along, width=width, known=baseline.rigid)
    except DiagnosisError:
        return None
    linear = {p.name for p in effect.list_parameters(contexts) if p.linear}
    values = {name: size * value if name in linear else value for name, value in shapes[best].items()}
    theta = baseline.fit.theta.copy()
    theta[:BODY_AND_CURVES] = pack(plant)[:BODY_AND_CURVES]
    moved = Structure(contexts).move_contexts(theta)
    return Structure(moved, (Candidate(effect.name, tuple(values.items())),)), theta
