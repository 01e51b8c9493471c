"""How much more probable other models make a recording, from one look at it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from fricomp.laws import FloatArray

from .coordinates import ArmModel, Coordinates, measure_sizes
from .equations import N_LAST, ArmEquations
from .fit import ArmFit
from .friction import TERMS, JointForm
from .prior import ArmPrior


class _Look(NamedTuple):
    """One model at the point of a glance.

    Attributes:
        at: Places of its parameters among all.
        deviation: Of its prior.
        scaled: Curvature in units of these.
        step: To its least objective, in the same.
        evidence: Its logarithm, up to a constant of the glance.
    """

    at: NDArray[np.intp]
    deviation: FloatArray
    scaled: FloatArray
    step: FloatArray
    evidence: float


class Glance:
    """How much more probable other models make a recording, by the slope and curvature at a fit of one of them.

    One linearisation with all terms serves every model that has some of them: their evidence is exact as far as the
    equations are linear, which all of friction is.

    Args:
        equations: Of all joints.
        fit: Where they are linearised.
        prior: How far the simulation is trusted.
    """

    def __init__(self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> None:
        whole = JointForm(tuple((term.name, k) for term in TERMS.values() for k in range(len(term.values))))
        every = Coordinates(fit.arm, ArmModel(tuple(whole for _ in fit.arm.joints)))
        self._fit, self._prior, self._sizes = fit, prior, measure_sizes(fit.arm, equations, prior)
        self._x = every.take_over(fit.model, fit.x, np.zeros(every.size))
        self._H, self._g, _ = every.linearise(equations, self._x)
        self._rigid, self._starts = every.n_inertial + len(fit.arm.joints), [place.start for place in every.places]
        self._numbers = {name: k for k, name in enumerate(whole.columns)}
        self._now = self._look(fit.model).evidence

    @property
    def n_links(self) -> int:
        """Number of links."""
        return len(self._fit.arm.links)

    def measure_gain(self, model: ArmModel) -> float:
        """Logarithm of the Bayes factor of a model against the one that was fitted."""
        return self._look(model).evidence - self._now

    def solve(self, model: ArmModel) -> ArmFit:
        """The fit of a model, as far as the equations are linear; its evidence is beside the others of this glance."""
        look = self._look(model)
        spread = np.linalg.inv(look.scaled) * np.outer(look.deviation, look.deviation)
        return replace(
            self._fit,
            model=model,
            x=self._x[look.at] + look.deviation * look.step,
            covariance=spread,
            prior_deviation=look.deviation,
            log_evidence=look.evidence,
        )

    def _look(self, model: ArmModel) -> _Look:
        mean, deviation = Coordinates(self._fit.arm, model).place_prior(self._sizes, self._prior)
        at = self._find(model)
        away = (self._x[at] - mean) / deviation
        scaled = self._H[np.ix_(at, at)] * np.outer(deviation, deviation) + np.eye(at.size)
        slope, loss = self._take_out(at)
        pull = deviation * slope - away
        factors = lu_factor(scaled, check_finite=False)
        step = lu_solve(factors, pull, check_finite=False)
        volume = float(np.sum(np.log(np.abs(np.diag(factors[0])))))
        return _Look(at, deviation, scaled, step, 0.5 * (float(pull @ step) - float(away @ away) - volume) - loss)

    def _take_out(self, at: NDArray[np.intp]) -> tuple[FloatArray, float]:
        """Downward slope at some places, and half of what the squares grow by, with all that is elsewhere at none."""
        there = self._x != 0.0
        there[at] = False
        out = np.flatnonzero(there)
        if not out.size:
            return self._g[at], 0.0
        gone = self._x[out]
        turn = self._H[:, out] @ gone
        return self._g[at] + turn[at], float(gone @ (self._g[out] + 0.5 * turn[out]))

    def _find(self, model: ArmModel) -> NDArray[np.intp]:
        """Places of a model's parameters among all."""
        at = list(range(self._rigid))
        for form, start in zip(model.forms, self._starts, strict=True):
            at += [start + self._numbers[name] for name in form.columns]
        return np.array([*at, *range(self._x.size - N_LAST, self._x.size)])
