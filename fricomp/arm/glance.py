"""How much more probable other models make a recording, from one look at it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from fricomp.laws import FloatArray

from .coordinates import ArmModel, place_parameters
from .equations import N_LAST, ArmEquations
from .fit import ArmFit
from .friction import TERMS, JointForm
from .prior import ArmPrior
from .prior.sizes import HELD_PART, PriorSizes, size_friction
from .squares import WeightedSquares


class _Look(NamedTuple):
    """One model at the point of a glance.

    Attributes:
        at: Places of its parameters among all.
        deviation: Of its prior.
        slope: Downward, by all parameters, where those that it lacks are none.
        scaled: Curvature in units of the deviations.
        factors: Of it.
        step: To its least objective, in the same units.
        evidence: Its logarithm, up to a constant of the glance.
    """

    at: NDArray[np.intp]
    deviation: FloatArray
    slope: FloatArray
    scaled: FloatArray
    factors: tuple[FloatArray, NDArray[np.intc]]
    step: FloatArray
    evidence: float


class _Rest(NamedTuple):
    """What all parameters of a joint would do beside a model, in units of their deviations [zhang2005schur].

    Attributes:
        curvature: That which no parameter of the model has. Shape (n, n).
        pull: Downward slope where the model is best. Shape (n,).
    """

    curvature: FloatArray
    pull: FloatArray


class Glance:
    """How much more probable other models make a recording, by the slope and curvature at a fit of one of them.

    One linearisation with all terms serves every model that has some of them: their evidence is exact as far as the
    equations are linear, which all of friction is. A model is looked at as what it has in common with the fit, which
    many models share, and the few columns that it has beyond that.

    Args:
        equations: Of all joints.
        fit: Where they are linearised.
        prior: How far the simulation is trusted.
    """

    def __init__(self, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> None:
        whole = JointForm(tuple((term.name, k) for term in TERMS.values() for k in range(len(term.values))))
        every = place_parameters(fit.arm, ArmModel(tuple(whole for _ in fit.arm.joints)))
        self._fit, self._prior, self._sizes = fit, prior, PriorSizes.of(equations.torque_sizes, prior)
        self._x = every.take_over(fit.model, fit.x, np.zeros(every.size))
        self._H, self._g, _ = WeightedSquares(every, equations).linearise(self._x)
        self._rigid, self._starts = every.n_inertial + len(fit.arm.joints), [place.start for place in every.places]
        self._numbers = {name: k for k, name in enumerate(whole.columns)}
        self._known: dict[ArmModel, _Look] = {}
        self._rests: dict[tuple[ArmModel, int], _Rest] = {}
        self._now = self._look(fit.model).evidence

    @property
    def n_links(self) -> int:
        """Number of links."""
        return len(self._fit.arm.links)

    def measure_gain(self, model: ArmModel) -> float:
        """Logarithm of the Bayes factor of a model against the one that was fitted."""
        pairs = zip(model.forms, self._fit.model.forms, strict=True)
        shared = [form if form == own else form.keep_terms(own.terms) for form, own in pairs]
        common = replace(model, forms=tuple(shared), pinned=_keep_pins(model.pinned, shared))
        if common not in self._known:
            self._known[common] = self._look(common)
        known = self._known[common]
        own = [(j, form.drop_columns(less)) for j, (form, less) in enumerate(zip(model.forms, shared, strict=True))]
        more = [(j, names) for j, names in own if names]
        if len(more) > 1:
            return self._look(model).evidence - self._now
        return known.evidence - self._now + sum(self._weigh_more(common, *one, model) for one in more)

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

    def _weigh_more(self, common: ArmModel, joint: int, names: Sequence[str], model: ArmModel) -> float:
        """By how much parameters of one joint that a model has beyond a common one raise its evidence."""
        rest = self._find_rest(common, joint)
        at = np.array([self._numbers[name] for name in names])
        held = np.array([HELD_PART if (joint, name) in model.pinned else 1.0 for name in names])
        own, pull = rest.curvature[at[:, None], at] * held[:, None] * held + np.eye(at.size), rest.pull[at] * held
        return 0.5 * float(pull @ np.linalg.solve(own, pull) - np.linalg.slogdet(own)[1])

    def _find_rest(self, common: ArmModel, joint: int) -> _Rest:
        if (common, joint) not in self._rests:
            look, start = self._known[common], self._starts[joint]
            deviation = size_friction(self._sizes, self._prior, joint, tuple(self._numbers), frozenset())
            at = slice(start, start + deviation.size)
            across = self._H[look.at, at] * look.deviation[:, None] * deviation
            seen = lu_solve(look.factors, across, check_finite=False)
            own = self._H[at, at] * deviation[:, None] * deviation
            self._rests[common, joint] = _Rest(own - across.T @ seen, deviation * look.slope[at] - across.T @ look.step)
        return self._rests[common, joint]

    def _look(self, model: ArmModel) -> _Look:
        mean, deviation = place_parameters(self._fit.arm, model).place_prior(self._sizes, self._prior)
        at = self._find(model)
        away = (self._x[at] - mean) / deviation
        scaled = self._H[np.ix_(at, at)] * np.outer(deviation, deviation) + np.eye(at.size)
        slope, loss = self._take_out(at)
        pull = deviation * slope[at] - away
        factors = lu_factor(scaled, check_finite=False)
        step = lu_solve(factors, pull, check_finite=False)
        volume = float(np.sum(np.log(np.abs(np.diag(factors[0])))))
        evidence = 0.5 * (float(pull @ step) - float(away @ away) - volume) - loss
        return _Look(at, deviation, slope, scaled, factors, step, evidence)

    def _take_out(self, at: NDArray[np.intp]) -> tuple[FloatArray, float]:
        """Downward slopes, and half of what the squares grow by, with all that is not at some places at none."""
        there = self._x != 0.0
        there[at] = False
        out = np.flatnonzero(there)
        if not out.size:
            return self._g, 0.0
        gone = self._x[out]
        turn = self._H[:, out] @ gone
        return self._g + turn, float(gone @ (self._g[out] + 0.5 * turn[out]))

    def _find(self, model: ArmModel) -> NDArray[np.intp]:
        """Places of a model's parameters among all."""
        at = list(range(self._rigid))
        for form, start in zip(model.forms, self._starts, strict=True):
            at += [start + self._numbers[name] for name in form.columns]
        return np.array([*at, *range(self._x.size - N_LAST, self._x.size)])


def _keep_pins(pinned: frozenset[tuple[int, str]], forms: Sequence[JointForm]) -> frozenset[tuple[int, str]]:
    """Those of parameters that these forms have."""
    return frozenset((j, name) for j, name in pinned if name in forms[j].columns)
