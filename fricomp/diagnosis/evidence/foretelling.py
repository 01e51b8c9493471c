"""Whether a ripple that is found at some angles foretells what the joint does at the others.

Leaving out blocks of time cannot test this in a periodic motion: every period reverses at the same angles, and a wave
with enough overtones fits whatever happens there. A real ripple comes from a rotating part and is there at all angles.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..effects import EFFECTS
from ..effects.structure import N_BASE
from ..inputs.track import FloatArray
from ..joint.solver import Box, Fit
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from .confirmation import compute_move
from .settings import FORETELLING


def list_local_ripples(baseline: Baseline, chosen: Explanation) -> dict[str, str]:
    """Say what speaks against ripples that are seen at some angles only; nothing for others.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        chosen: The explanation.
    """
    contexts = chosen.structure.contexts
    angles = [one.position[grid.centres] for one, grid in zip(contexts, baseline.problem.grids, strict=True)]
    rank = np.argsort(np.argsort(np.concatenate(angles), kind="stable"), kind="stable")
    span = float(np.ptp(np.concatenate(angles)))
    found = {}
    for name in chosen.names:
        waves = chosen.values[name].get("order", 0.0) * span / (2.0 * np.pi) if EFFECTS[name].ripple else 0.0
        count = int(min(waves / FORETELLING.waves, FORETELLING.most))
        if count >= FORETELLING.fewest and not _foretells(baseline, chosen, name, rank * count // rank.size):
            found[name] = "what it does at some angles does not foretell what it does at the others"
    return found


def _foretells(baseline: Baseline, chosen: Explanation, name: str, band: NDArray[np.intp]) -> bool:
    """Whether a ripple lessens the error in bands of the angle that are left out of its fit in turn, and not in some at
    the cost of others.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        chosen: The explanation.
        name: The ripple.
        band: Of each row. Shape (m,).
    """
    structure, fit = chosen.structure, chosen.fit
    box = chosen.box.join(structure.build_box())
    others = np.array([True] * N_BASE + [owner != name for owner, _ in structure.parameters])
    added = structure.compute_added(baseline.problem, fit.theta, (name,))
    without = replace(fit, residual=fit.residual - added, jacobian=fit.jacobian * others)
    won = lost = 0.0
    for one in np.unique(band):
        test = band == one
        before, after = (_predict(side, box, ~test)[test] for side in (without, fit))
        fall = float(before @ before - after @ after)
        won, lost = won + max(fall, 0.0), lost + max(-fall, 0.0)
    return lost < FORETELLING.lost * won


def _predict(fit: Fit, box: Box, train: NDArray[np.bool_]) -> FloatArray:
    """Residual of all rows after a step that fits these of them, as a line. Shape (m,)."""
    predicted: FloatArray = fit.residual + fit.jacobian @ compute_move(fit, box, train)
    return predicted
