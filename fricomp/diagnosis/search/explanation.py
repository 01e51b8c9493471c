"""An explanation: a structure fitted jointly, and what speaks for it in rows that can show its effects."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.solver import Box, Fit
from .preparation import Baseline
from .screening import orthonormalise, project_out

__all__ = ["Explanation", "compute_evidence", "compute_spread_excess", "curb", "find_refusal", "judge"]

_MOST_OF_A_ROW = 9.0  # gain that one row may add to what counts against the threshold
_FAIR = 0.5  # of what an effect of sliding would explain in the rows that slide, were it spread evenly, that it must
_LOUD_ABOUT_REST = 0.6  # gain per row there; the form of the bristle has been seen to leave 0.3 of nothing missing
_FORM_OF_BRISTLE = 0.1  # gain per row there, that effects like a bristle take up of its form alone
_BRISTLE = 0.3  # such energy per row there, that is not held against an explanation
# Gain per row of all, and coverage, of an explanation that counts wherever it shows. Joints with nothing missing
# reach 0.25 and 0.99 by the form of their bristle, all of it about rest.
_PLAIN, _PLAINLY_COVERED = 0.3, 0.85
_DETENT, _SAME_ORDER, _LIKE_SIZE = ("cogging", "position_coulomb"), 0.05, 0.25
# Share of the torque that grows with speed, which is linear, below which a power law has taken the place of viscous
# friction: it bends then as no power law would where it covers less than this, or is at the edge of its domain.
_LAW, _DRAG, _TAKEN, _FITS, _AT_EDGE = "power_law_viscous", "quadratic_drag", 0.2, 0.97, 0.01
_LATE, _LAGGING, _ALIKE = "torque_delay", "drive_lag", 0.3  # relative difference of their times
# Energy that has to be left for that, in all and per row: a weak effect is covered less by chance, and in a long
# recording the form of a law is seen that no other one of the catalogue has.
_CLEARLY, _CLEARLY_PER_ROW = 60.0, 0.02


@dataclass(frozen=True, eq=False)
class Explanation:
    """A structure fitted jointly.

    Attributes:
        structure: Base and effects.
        fit: The minimum.
        box: Domain and priors of its base: the usual ones, or with inertia and gravity held to the simulation.
        gain: Fall of the cost from the base, less the BIC penalty.
        certain: The same from rows that can show the effects, none counting for more than a few: rows about rest hang
            on a bristle that no model has quite right, and a handful of rows decides nothing.
        coverage: Part of the explainable energy that it covers.
        left: Energy that a generic basis explains of what it leaves, beyond chance.
        refused: Why it is not physical; empty where it is.
        before: What it is judged against in place of the base: that with inertia and gravity as the simulation has
            them; None where they were free in both.
    """

    structure: Structure
    fit: Fit
    box: Box
    gain: float
    certain: float
    coverage: float
    left: float = 0.0
    refused: str = ""
    before: Fit | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its effects, sorted."""
        return self.structure.names

    @property
    def values(self) -> dict[str, dict[str, float]]:
        """Fitted parameters of each effect."""
        return self.structure.name_values(self.fit.theta[N_BASE:])

    def compute_reach(self, prepared: Baseline) -> FloatArray:
        """What its effects add to each row, in units of the noise. Shape (m,)."""
        return self.structure.compute_added(prepared.problem, self.fit.theta, self.names)

    @property
    def common_order(self) -> float | None:
        """Order in which a torque and a friction of like size follow the position: one part makes both, as a detent."""
        values = self.values
        waves = [values[name] for name in _DETENT if name in values]
        if len(waves) < len(_DETENT):
            return None
        low, high = sorted(wave["order"] for wave in waves)
        small, large = sorted(float(np.hypot(wave["sine"], wave["cosine"])) for wave in waves)
        return 0.5 * (low + high) if high - low < _SAME_ORDER * high and small > _LIKE_SIZE * large else None

    @property
    def foreign_curve(self) -> bool:
        """Whether its friction over speed has another form than its names say: a power law in place of all viscous
        friction, that drag has to straighten or that does not fit.
        """
        values = self.values
        if _LAW not in values:
            return False
        law, drag = values[_LAW], values.get(_DRAG, {"coefficient": 0.0})
        plant = self.structure.unpack_plant(self.fit.theta)
        top = max(float(np.max(np.abs(context.velocity))) for context in self.structure.contexts)
        linear = 0.5 * (plant.forward[3] + plant.reverse[3]) * top
        curved = law["coefficient"] * top ** law["exponent"] + drag["coefficient"] * top**2
        if linear > _TAKEN * (linear + curved):
            return False
        (exponent,) = (p for owner, p in self.structure.parameters if (owner, p.name) == (_LAW, "exponent"))
        at_edge = law["exponent"] < exponent.lower + _AT_EDGE
        clearly = max(_CLEARLY, _CLEARLY_PER_ROW * self.fit.residual.size)
        return _DRAG in values or at_edge or (self.coverage < _FITS and self.left > clearly)

    @property
    def settled(self) -> tuple[Candidate, ...]:
        """Its effects, starting where their fit ended."""
        values = self.values
        return tuple(Candidate(c.name, tuple(values[c.name].items())) for c in self.structure.candidates)


def judge(prepared: Baseline, structure: Structure, fit: Fit, box: Box) -> Explanation:
    """What speaks for a structure whose base was fitted in `box`, and against it."""
    fall = prepared.fit.cost - fit.cost
    penalty = structure.freedom * float(np.log(fit.residual.size))
    left = _compute_left(prepared, fit)
    coverage = fall / (fall + left) if fall > 0.0 else 0.0
    plain = fall > _PLAIN * fit.residual.size and coverage > _PLAINLY_COVERED
    certain = compute_evidence(prepared, structure.names, prepared.fit, fit, plain=plain)
    refused = find_refusal(structure, fit)
    return Explanation(structure, fit, box, fall - penalty, certain - penalty, float(coverage), left, refused)


def compute_evidence(
    prepared: Baseline,
    names: Collection[str],
    before: Fit,
    after: Fit,
    *,
    plain: bool = False,
    at: NDArray[np.bool_] | None = None,
) -> float:
    """Fall of the cost in rows that can show the effects `names`, none counting for more than a few.

    Nothing where too little of it lies where the joint slides: effects of sliding reach rest only by bending the
    bristle. A fall about rest that no error of the bristle's form reaches counts for any of them; those that are
    like a bristle take up a part of that error themselves.

    Args:
        prepared: Base model and recordings.
        names: The effects.
        before: Fit without them.
        after: Fit with them.
        plain: Whether they bring and cover so much that they count wherever they show.
        at: Rows that are looked at, shape (m,); None for all of them.
    """
    fall, rows = _compute_falls(before, after), prepared.sliding
    if at is not None:
        fall, rows = fall[at], rows[at]
    about_rest = float(np.mean(fall[~rows])) if not np.all(rows) else 0.0
    if any(EFFECTS[name].like_a_bristle for name in names):
        return float(np.sum(fall) - _FORM_OF_BRISTLE * np.sum(~rows))
    if plain or about_rest > _LOUD_ABOUT_REST or any(EFFECTS[name].shown_at_rest for name in names):
        return float(np.sum(fall))
    sliding, fair = float(np.sum(fall[rows])), float(np.sum(fall)) * float(np.mean(rows))
    return sliding if sliding > _FAIR * fair else min(sliding, 0.0)


def _compute_falls(before: Fit, after: Fit) -> FloatArray:
    """Fall of the cost in each row, none counting for more than a few. Shape (m,)."""
    return np.clip(before.residual**2 - after.residual**2, -_MOST_OF_A_ROW, _MOST_OF_A_ROW)


def _compute_left(prepared: Baseline, fit: Fit) -> float:
    """Energy that the generic basis explains of what a fit leaves, beyond chance and the form of the bristle."""
    span, about_rest = (
        orthonormalise(project_out(prepared.generic, orthonormalise(fit.jacobian)), 1e-4),
        ~prepared.sliding,
    )
    bristle = _compute_excess(span * about_rest[:, None], fit.residual)
    of_its_form = float(np.clip(bristle, 0.0, _BRISTLE * np.sum(about_rest)))
    return max(_compute_excess(span, fit.residual) - of_its_form, 0.0)


def find_refusal(structure: Structure, fit: Fit) -> str:
    """Why a fit is not physical; empty where it is."""
    values = structure.name_values(fit.theta[N_BASE:])
    reasons = [c.effect.refuse(values[c.name], structure.contexts) for c in structure.candidates]
    return "; ".join(reason for reason in (*reasons, _find_cancelling(values)) if reason)


def _find_cancelling(values: Mapping[str, Mapping[str, float]]) -> str | None:
    """Why a torque that is recorded late and acts late by the same time is neither: hardly anything is left of both."""
    if not {_LATE, _LAGGING} <= values.keys():
        return None
    delay, lag = values[_LATE]["delay"], values[_LAGGING]["time_constant"]
    return "delay and lag would cancel" if abs(delay - lag) < _ALIKE * max(delay, lag) else None


def _compute_excess(span: FloatArray, residual: FloatArray) -> float:
    """Energy explained by `span`, orthonormal or some rows of it, beyond what noise gives."""
    return float(np.sum((span.T @ residual) ** 2) - np.sum(span**2))


def compute_spread_excess(span: FloatArray, residual: FloatArray) -> float:
    """The same where no row counts for more than a few: one bad moment is no physics."""
    return _compute_excess(span, curb(residual))


def curb(residual: FloatArray) -> FloatArray:
    """A residual in which no row is more than a few times the noise. Shape (m,)."""
    limit = float(np.sqrt(_MOST_OF_A_ROW))
    return np.clip(residual, -limit, limit)
