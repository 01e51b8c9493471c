"""The Stribeck curve of each joint: its velocity and exponent move along the slope to where they fit best, and another
start may lead to a better one.

A curve is taken in before what else acts in a joint is, and then stands in for some of that: one of a wrong exponent,
or at a wrong velocity, bends Coulomb and viscous friction, and no small step leads to the right one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import CREEP, MOST_STRIBECK, TERMS, JointForm, is_rounded
from ..glance import Glance
from ..prior import ArmPrior
from ..rows import ArmRows

_ROUNDS = 12
"""Of moving all curves; each leaves about the square of the distance before."""

_STEP = 0.5
"""Longest step of the logarithm of a velocity, or of an exponent."""

_STILL = 0.02
"""Step of such a logarithm below which it stands still."""

_MOVES = {"stribeck": slice(2, None), CREEP: slice(1, None)}
"""Of the parameters of a term, those along which its curve moves."""

_TRIED = 3
"""Other curves that are tried, the most promising first."""

_BETTER = 1.0
"""Logarithm of the Bayes factor by which another curve must be better, or changes of it would not end."""

_END = 0.95
"""Part of the furthest fall of a curve, and of its highest velocity, from which it is taken to be pressed against that:
moves end short of where they would be none."""


class SuitedCurve(NamedTuple):
    """Another model with the curve that suits it.

    Attributes:
        model: The other one.
        lost: Logarithm of the Bayes factor of the fit against it.
        fit: Of that model, with its curve where it is most probable.
        equations: With that curve.
    """

    model: ArmModel
    lost: float
    fit: ArmFit
    equations: ArmEquations


def refine_stribeck(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior
) -> tuple[ArmFit, ArmEquations]:
    """Change the Stribeck curves of a fit, as long as that makes the recording more probable.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
    """
    fit, equations = _move_curves(rows, equations, fit, prior)
    while True:
        better = _find_better(rows, equations, fit, prior)
        if better is None:
            return _hold_loose(equations, fit, prior), equations
        fit, equations = _move_curves(rows, better[1], better[0], prior)


def _hold_loose(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> ArmFit:
    """The fit in which curves that are none where they may move stand still."""
    model = fit.model
    for j, form in enumerate(model.forms):
        model = hold_curve(model, j) if "stribeck" in form.names and not is_curve(fit, j) else model
    return fit if model == fit.model else fit_arm(fit.arm, equations, model, prior, fit)


def hold_curve(model: ArmModel, joint: int) -> ArmModel:
    """The model in which Stribeck velocity and exponent of a joint stand still.

    Free to move it makes a curve of nearly any form, so that forms are told apart by what they are where they stand.

    Args:
        model: With a curve in this joint.
        joint: Its number.
    """
    return _hold_moves(model, joint, "stribeck")


def _hold_moves(model: ArmModel, joint: int, term: str) -> ArmModel:
    return replace(model, pinned=model.pinned | _name_moves(model.forms[joint], joint, (term,)))


def _name_moves(form: JointForm, joint: int, terms: Collection[str] = tuple(_MOVES)) -> set[tuple[int, str]]:
    """The parameters along which the curves of a joint move."""
    known = {term: variant for term, variant in form.terms if term in terms}
    return {(joint, name) for term, k in known.items() for name in TERMS[term].names(k)[_MOVES[term]]}


def _free_curves(model: ArmModel) -> ArmModel:
    moves = (_name_moves(form, j) for j, form in enumerate(model.forms))
    return replace(model, pinned=model.pinned.difference(*moves))


def _find_better(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior
) -> tuple[ArmFit, ArmEquations] | None:
    """The fit with another curve in one joint, which is more probable where it stands; None for none."""
    others = _list_others(equations, fit, prior)
    now = _weigh_still(equations, fit, prior) if others else 0.0
    for other in others[:_TRIED]:
        there = fit_arm(fit.arm, equations, other, prior, fit)
        there, moved = _move_curves(rows, equations, there, prior, _list_changed(fit.model, other))
        if _weigh_still(moved, there, prior) > now + _BETTER:
            return there, moved
    return None


def _list_changed(model: ArmModel, other: ArmModel) -> list[int]:
    """Joints that two models differ in."""
    return [j for j, (form, before) in enumerate(zip(other.forms, model.forms, strict=True)) if form != before]


def _list_others(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> list[ArmModel]:
    """Models in which the curve of one joint is another one that promises to be better, the most probable first."""
    curved = [(j, form, term) for j, form in enumerate(fit.model.forms) for term in _MOVES if term in form.names]
    if not curved:
        return []
    glance, gains = Glance(equations, fit, prior), []
    for j, form, term in curved:
        now = glance.measure_gain(_hold_moves(fit.model, j, term))
        for k in range(len(TERMS[term].values)):
            other = fit.model.with_form(j, form.with_variant(term, k))
            gain = glance.measure_gain(other) - now  # it may move, as it will
            if gain > _BETTER and (term == CREEP or is_curve(glance.solve(hold_curve(other, j)), j)):
                gains.append((gain, other))
    return [other for _, other in sorted(gains, key=lambda pair: -pair[0])]


def suit_curve(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, other: ArmModel, joint: int
) -> SuitedCurve | None:
    """Another model of a joint with the curve that suits that; None where none falls with the speed.

    Every friction law has a curve, and what bends over the speed is weighed beside one that stands still: a curve of a
    wrong exponent, or none, asks for it.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
        other: The model of the fit without something, or with something that was held, in that joint.
        joint: Its number.
    """
    if "stribeck" not in other.forms[joint].names:
        glance = Glance(equations, fit, prior)
        curves = [_with_curve(other, joint, k) for k in range(len(TERMS["stribeck"].values))]
        curves = [one for one in curves if is_curve(glance.solve(hold_curve(one, joint)), joint)]
        if not curves:
            return None
        other = max(curves, key=glance.measure_gain)
    there, moved = refine_stribeck(rows, equations, fit_arm(fit.arm, equations, other, prior, fit), prior)
    lost = _weigh_still(equations, fit, prior) - _weigh_still(moved, there, prior)
    return SuitedCurve(other, lost, there, moved)


def suit_creep(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, other: ArmModel, joint: int
) -> SuitedCurve:
    """Another model of a joint with the form and the speed of friction that creeps that suit that.

    A part that creeps with one form, and a bristle beside it, make up for another form.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
        other: The model of the fit without something in that joint.
        joint: Its number.
    """
    glance, size = Glance(equations, fit, prior), len(TERMS[CREEP].values)
    bare = other.with_form(joint, other.forms[joint].without_term(CREEP))
    every = [_with_curve(bare, joint, k, CREEP) for k in range(size)]
    starts = [max(own, key=glance.measure_gain) for own in (_pick(every, rounded=one) for one in (False, True))]
    now, found = _weigh_still(equations, fit, prior), []
    for start in starts:
        there, moved = refine_stribeck(rows, equations, fit_arm(fit.arm, equations, start, prior, fit), prior)
        found.append(SuitedCurve(there.model, now - _weigh_still(moved, there, prior), there, moved))
    return min(found, key=lambda one: one.lost)


def _pick(models: Sequence[ArmModel], *, rounded: bool) -> list[ArmModel]:
    """Of models with each variant of friction that creeps, those of one form."""
    return [model for k, model in enumerate(models) if is_rounded(k) == rounded]


def _with_curve(model: ArmModel, joint: int, variant: int, term: str = "stribeck") -> ArmModel:
    """The model with a curve in a joint that has none."""
    return model.with_form(joint, model.forms[joint].with_term(term, variant))


def _weigh_still(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> float:
    """Logarithm of the evidence of the curves where they stand; nothing where one is none."""
    model = fit.model
    moves = (_name_moves(form, j) for j, form in enumerate(model.forms))
    model = replace(model, pinned=model.pinned.union(*moves))
    still = fit_arm(fit.arm, equations, model, prior, fit)
    falls = [is_curve(still, j) for j, form in enumerate(model.forms) if "stribeck" in form.names]
    return still.log_evidence if all(falls) else -np.inf


def is_curve(fit: ArmFit, joint: int) -> bool:
    """Whether the Stribeck curve of a joint falls with the speed, by no more than the level that it falls to.

    One that rises stands in for what else does; one that falls by more, over most of the speeds, is drag turned round.
    """
    excess = TERMS["stribeck"].names(dict(fit.model.forms[joint].terms)["stribeck"])[0]
    values = fit.friction(joint)
    return 0.0 < values[excess] <= values["coulomb"]


def is_at_end(equations: ArmEquations, fit: ArmFit, joint: int) -> bool:
    """Whether the Stribeck curve of a joint falls by as much as one may, or as slowly: what it stands for would bend
    further, and is no curve."""
    variant = dict(fit.model.forms[joint].terms)["stribeck"]
    values, excess = fit.friction(joint), TERMS["stribeck"].names(variant)[0]
    speed = float(equations.stribeck[joint, variant, 0]) / (MOST_STRIBECK * float(equations.top_speed[joint]))
    return max(values[excess] / values["coulomb"], speed) > _END


def _move_curves(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, joints: Sequence[int] | None = None
) -> tuple[ArmFit, ArmEquations]:
    """Move all curves, or those of some joints, to where they are most probable as they stand: their slopes alone fit
    what no curve does."""
    model = _free_curves(fit.model)
    fit = fit if model == fit.model else fit_arm(fit.arm, equations, model, prior, fit)
    chosen = range(len(model.forms)) if joints is None else joints
    step, most = _find_steps(equations, fit, chosen), None
    for _ in range(_ROUNDS):
        step = {name: np.where(np.abs(one) > _STILL, one, 0.0) for name, one in step.items()}  # others are known
        if not any(np.any(one) for one in step.values()):
            break
        most = _weigh_still(equations, fit, prior) if most is None else most
        moved = equations.with_stribeck(rows, equations.stribeck * np.exp(step["stribeck"]))
        moved = moved.with_creep(rows, equations.creep * np.exp(step[CREEP]))
        there = fit_arm(fit.arm, moved, fit.model, prior, fit)
        if (weight := _weigh_still(moved, there, prior)) > most:
            fit, equations, step, most = there, moved, _find_steps(moved, there, chosen), weight
        else:
            step = {name: 0.5 * one for name, one in step.items()}
    return fit, equations


def _find_steps(equations: ArmEquations, fit: ArmFit, joints: Sequence[int]) -> dict[str, FloatArray]:
    """How far logarithms of velocities and exponents of some joints are from where they fit best; none of the others.
    Shapes as `equations.stribeck` and `equations.creep`."""
    steps = {"stribeck": np.zeros_like(equations.stribeck), CREEP: np.zeros((*equations.creep.shape, 1))}
    for j in joints:
        for term, variant in fit.model.forms[j].terms:
            if term not in _MOVES:
                continue
            values, moves = [fit.friction(j)[name] for name in TERMS[term].names(variant)], _MOVES[term]
            step = np.array(values[moves]) / values[0] if values[0] > 0.0 else np.zeros(len(values[moves]))
            steps[term][j, variant] = step * min(1.0, _STEP / max(float(np.max(np.abs(step))), _STEP))
    return steps | {CREEP: steps[CREEP][:, :, 0]}
