"""An explanation: a structure fitted jointly, and what speaks for it in rows that can show its effects."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..effects import EFFECTS
from ..effects.identity import find_identity
from ..effects.structure import N_BASE, Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.solver import Box, Fit
from .preparation import Baseline
from .screening import orthonormalise, project_out
from .settings import SEARCH


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

    def compute_reach(self, baseline: Baseline) -> FloatArray:
        """What its effects add to each row, in units of the noise. Shape (m,)."""
        return self.structure.compute_added(baseline.problem, self.fit.theta, self.names)

    @property
    def common_order(self) -> float | None:
        """Order at which a torque and a friction of like size follow the position. One part makes both, such as a
        detent."""
        waves = {EFFECTS[name].wave: one for name, one in self.values.items() if EFFECTS[name].wave}
        if len(waves) < 2:
            return None
        low, high = sorted(wave["order"] for wave in waves.values())
        small, large = sorted(float(np.hypot(wave["sine"], wave["cosine"])) for wave in waves.values())
        alike = high - low < SEARCH.same_order * high and small > SEARCH.like_size * large
        return 0.5 * (low + high) if alike else None

    @property
    def foreign_curve(self) -> bool:
        """Whether its friction over speed has another form than its names say: a power law takes the place of all
        viscous friction, and drag has to straighten it, or it does not fit."""
        values = self.values
        if not any(EFFECTS[name].viscous_exponent for name in values):
            return False
        plant = self.structure.unpack_plant(self.fit.theta)
        top = max(float(np.max(np.abs(context.velocity))) for context in self.structure.contexts)
        linear = 0.5 * (plant.forward[3] + plant.reverse[3]) * top
        drawn = (EFFECTS[name].compute_curve(one, top) for name, one in values.items())
        curves = [torque for torque in drawn if torque is not None]
        curved = sum(curves)
        if linear > SEARCH.viscous_left * (linear + curved):
            return False
        at_edge = any(
            values[owner][p.name] < p.lower + SEARCH.exponent_edge
            for owner, p in self.structure.parameters
            if p.name == EFFECTS[owner].viscous_exponent
        )
        clearly = max(SEARCH.clearly_left, SEARCH.clearly_left_per_row * self.fit.residual.size)
        return len(curves) > 1 or at_edge or (self.coverage < SEARCH.curve_fits and self.left > clearly)

    @property
    def settled(self) -> tuple[Candidate, ...]:
        """Its effects, starting where their fit ended."""
        values = self.values
        return tuple(Candidate(c.name, tuple(values[c.name].items())) for c in self.structure.candidates)

    @property
    def settled_structure(self) -> Structure:
        """Its structure, starting there."""
        return replace(self.structure, candidates=self.settled)


def judge(baseline: Baseline, structure: Structure, fit: Fit, box: Box) -> Explanation:
    """Judge a structure whose base was fitted in `box`: what speaks for it, and against it."""
    fall = baseline.fit.cost - fit.cost
    penalty = structure.freedom * float(np.log(fit.residual.size))
    left = _compute_left(baseline, fit)
    coverage = fall / (fall + left) if fall > 0.0 else 0.0
    plain = fall > SEARCH.plain_gain * fit.residual.size and coverage > SEARCH.plain_coverage
    certain = compute_evidence(baseline, structure.names, baseline.fit, fit, plain=plain)
    refused = find_refusal(structure, fit, bodied=bool(box.precision[0, 0] > 0.0))
    return Explanation(structure, fit, box, fall - penalty, certain - penalty, float(coverage), left, refused)


def compute_evidence(
    baseline: Baseline,
    names: Collection[str],
    before: Fit,
    after: Fit,
    *,
    plain: bool = False,
    at: NDArray[np.bool_] | None = None,
) -> float:
    """Sum the fall of the cost over the rows that can show the effects `names`. No row counts for more than a few.

    Nothing where too little of it lies where the joint slides: effects of sliding reach rest only by bending the
    bristle. A fall about rest that no error of the bristle's form reaches counts for any of them; those that are
    like a bristle take up a part of that error themselves.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        names: The effects.
        before: Fit without them.
        after: Fit with them.
        plain: Whether they bring and cover so much that they count wherever they show.
        at: Rows that are looked at, shape (m,); None for all of them.
    """
    fall, rows = _compute_falls(before, after), baseline.sliding
    if at is not None:
        fall, rows = fall[at], rows[at]
    about_rest = float(np.mean(fall[~rows])) if not np.all(rows) else 0.0
    if any(EFFECTS[name].like_a_bristle for name in names):
        return float(np.sum(fall) - SEARCH.form_of_bristle * np.sum(~rows))
    if plain or about_rest > SEARCH.loud_about_rest or any(EFFECTS[name].shown_at_rest for name in names):
        return float(np.sum(fall))
    sliding, fair = float(np.sum(fall[rows])), float(np.sum(fall)) * float(np.mean(rows))
    return sliding if sliding > SEARCH.fair_share * fair else min(sliding, 0.0)


def _compute_falls(before: Fit, after: Fit) -> FloatArray:
    """Fall of the cost in each row, none counting for more than a few. Shape (m,)."""
    return np.clip(before.residual**2 - after.residual**2, -SEARCH.most_of_a_row, SEARCH.most_of_a_row)


def _compute_left(baseline: Baseline, fit: Fit) -> float:
    """Energy that the generic basis explains of what a fit leaves, beyond chance and the form of the bristle."""
    span, about_rest = (
        orthonormalise(project_out(baseline.generic, orthonormalise(fit.jacobian)), 1e-4),
        ~baseline.sliding,
    )
    bristle = _compute_excess(span * about_rest[:, None], fit.residual)
    of_its_form = float(np.clip(bristle, 0.0, SEARCH.forgiven_about_rest * np.sum(about_rest)))
    return max(_compute_excess(span, fit.residual) - of_its_form, 0.0)


def find_refusal(structure: Structure, fit: Fit, *, bodied: bool = False) -> str:
    """Say why a fit is not physical; empty where it is.

    Args:
        structure: Base and effects.
        fit: Its minimum.
        bodied: Whether a simulation says inertia and gravity.
    """
    values = structure.name_values(fit.theta[N_BASE:])
    same = None if bodied else find_identity(values)
    one = None if same is None else f"{same.one} and {same.other} are one torque: {same.equation}"
    reasons = [c.effect.refuse(values[c.name], structure.contexts) for c in structure.candidates]
    reasons += [_find_cancelling(structure, values), _find_shared_order(values), one]
    return "; ".join(reason for reason in reasons if reason)


def _find_shared_order(values: Mapping[str, Mapping[str, float]]) -> str | None:
    """Say why two ripples over position are none: they have one order, and so one cause. A torque and a friction that
    follow the position together are a detent (`Explanation.common_order`)."""
    orders = sorted((one["order"], name) for name, one in values.items() if {"order", "sine"} <= set(one))
    alike = [
        (low, high)
        for (small, low), (large, high) in pairwise(orders)
        if large - small < SEARCH.same_order * large and not (EFFECTS[low].wave and EFFECTS[high].wave)
    ]
    return f"{alike[0][0]} and {alike[0][1]} would be two ripples of one order" if alike else None


def _find_cancelling(structure: Structure, values: Mapping[str, Mapping[str, float]]) -> str | None:
    """Say why a delay and a lag of about the same time are neither: nearly nothing is left of both."""
    times = [(p.with_delay, values[owner][p.name]) for owner, p in structure.parameters if p.with_delay]
    delay, lag = (next((time for sign, time in times if sign * way > 0.0), None) for way in (-1.0, 1.0))
    if delay is None or lag is None:
        return None
    return "delay and lag would cancel" if abs(delay - lag) < SEARCH.alike_times * max(delay, lag) else None


def _compute_excess(span: FloatArray, residual: FloatArray) -> float:
    """Energy explained by `span`, orthonormal or some rows of it, beyond what noise gives."""
    return float(np.sum((span.T @ residual) ** 2) - np.sum(span**2))


def compute_spread_excess(span: FloatArray, residual: FloatArray) -> float:
    """Compute the same where no row counts for more than a few, since one bad moment is no physics."""
    return _compute_excess(span, curb(residual))


def curb(residual: FloatArray) -> FloatArray:
    """A residual in which no row is more than a few times the noise. Shape (m,)."""
    limit = float(np.sqrt(SEARCH.most_of_a_row))
    return np.clip(residual, -limit, limit)
