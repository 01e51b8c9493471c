"""How far base parameters stray beside an effect whose law has slightly another form than that of the joint."""

from __future__ import annotations

import numpy as np

from ..effects.settings import EFFECT
from ..effects.structure import N_BASE
from ..inputs.track import FloatArray
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from .confirmation import invert_curvature
from .refitted import RefittedJoint

_RANGES = 8
"""Ranges of position, and of velocity, in each of which a law is off by its own part one way or the other."""


def compute_form_strays(baseline: Baseline, chosen: Explanation | None, refitted: RefittedJoint) -> FloatArray:
    """Standard deviations by which the base follows what the law of an effect does not meet. Shape (N_BASE,).

    The law is off by a part of the torque that it adds, one way or the other in each range of position and of velocity:
    the base is refitted to that, since it is there in every part of the recording and no interval of the fit knows of
    it.

    Args:
        baseline: The base fitted to the recordings.
        chosen: What was named; None where nothing was, and nothing strays.
        refitted: The joint with it.
    """
    if chosen is None:
        return np.zeros(N_BASE)
    structure, fit = refitted.structure, refitted.fit
    box = chosen.box.join(structure.build_known_box())
    A, inverse = invert_curvature(fit, box)
    added = EFFECT.usual_form * structure.compute_added(baseline.problem, fit.theta, structure.names)
    places = list(zip(structure.contexts, baseline.problem.grids, strict=True))
    states = (
        np.concatenate([context.position[grid.centres] for context, grid in places]),
        np.concatenate([context.velocity[grid.centres] for context, grid in places]),
    )
    steps = [inverse @ (A[rows].T @ added[rows]) for state in states for rows in _split_evenly(state)]
    strays: FloatArray = box.scale * np.sqrt(np.sum(np.square(steps), axis=0))
    return strays[:N_BASE]


def _split_evenly(state: FloatArray) -> list[np.ndarray]:
    """Indices of rows in ranges of a state that hold as many of them each."""
    return np.array_split(np.argsort(state, kind="stable"), _RANGES)
