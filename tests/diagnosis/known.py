"""Explanations whose gain, residual and reach are known, for tests of what is made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.solver import Fit
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline

_FAR = 5.0  # in units of a row's noise, by which effects reach a row unless it is said otherwise


@dataclass(frozen=True, eq=False)
class Known(Explanation):
    """An explanation whose effects reach each row by `reached`."""

    reached: FloatArray | None = None

    def compute_reach(self, prepared: Baseline) -> FloatArray:
        return np.full(self.fit.residual.size, _FAR) if self.reached is None else self.reached


def fit_of(residual: FloatArray) -> Fit:
    """A fit without parameters that leaves `residual`."""
    return Fit(np.zeros(0), residual, np.zeros((residual.size, 0)), float(residual @ residual))


def known(names: Sequence[str], gain: float, residual: FloatArray | None = None, **more: Any) -> Known:
    """An explanation by the effects `names`, all of whose gain is certain; `more` are its other attributes."""
    structure = Structure((), tuple(Candidate(name, ()) for name in names))
    fit = fit_of(np.zeros(1) if residual is None else residual)
    plain = Known(structure, fit, Structure((), ()).build_box(), gain, gain, 0.9)
    return replace(plain, **more)
