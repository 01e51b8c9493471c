"""The Stribeck curve of each joint: its velocity moves along the slope to where it fits best, its form may change.

A curve is taken in before what else acts in a joint is, and then stands in for some of that: one of a wrong exponent,
or at a wrong velocity, bends Coulomb and viscous friction, and no small step of its velocity leads to the right one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.laws import FloatArray

from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import TERMS, JointForm
from ..glance import Glance
from ..prior import ArmPrior
from ..rows import ArmRows

_ROUNDS = 6
"""Of moving all velocities; each leaves about the square of the distance before."""

_STEP = 0.5
"""Longest step of a velocity's logarithm."""

_STILL = 0.02
"""Step of a velocity's logarithm below which it stands still."""

_TRIED = 3
"""Other curves that are tried, the most promising first."""

_BETTER = 1.0
"""Logarithm of the Bayes factor by which another curve must be better, or changes of it would not end."""


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
    fit, equations = _move_velocities(rows, equations, fit, prior)
    while True:
        better = _find_better(rows, equations, fit, prior)
        if better is None:
            return fit, equations
        fit, equations = better


def hold_velocity(model: ArmModel, joint: int) -> ArmModel:
    """The model in which the Stribeck velocity of a joint stands still.

    Free to move it makes a curve of nearly any form, so that forms are told apart by what they are where they stand.

    Args:
        model: With a curve in this joint.
        joint: Its number.
    """
    return replace(model, pinned=model.pinned | {(joint, _name_width(model.forms[joint]))})


def _name_width(form: JointForm) -> str:
    return TERMS["stribeck"].names(dict(form.terms)["stribeck"])[-1]


def _free_velocities(model: ArmModel) -> ArmModel:
    widths = {(j, _name_width(form)) for j, form in enumerate(model.forms) if "stribeck" in form.names}
    return replace(model, pinned=model.pinned - widths)


def _find_better(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior
) -> tuple[ArmFit, ArmEquations] | None:
    """The fit with another curve in one joint, which is more probable where its velocity stands; None for none."""
    others = _list_others(equations, fit, prior)
    now = _weigh_still(equations, fit, prior) if others else 0.0
    for other in others[:_TRIED]:
        there, moved = _move_velocities(rows, equations, fit_arm(fit.arm, equations, other, prior, fit), prior)
        if _weigh_still(moved, there, prior) > now + _BETTER:
            return there, moved
    return None


def _list_others(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> list[ArmModel]:
    """Models in which the curve of one joint is another one that promises to be better, the most probable first."""
    curved = [(j, form) for j, form in enumerate(fit.model.forms) if "stribeck" in form.names]
    if not curved:
        return []
    glance, gains = Glance(equations, fit, prior), []
    for j, form in curved:
        now = glance.measure_gain(hold_velocity(fit.model, j))
        for k in range(len(TERMS["stribeck"].values)):
            forms = (*fit.model.forms[:j], form.with_variant("stribeck", k), *fit.model.forms[j + 1 :])
            other = replace(fit.model, forms=forms)
            gain = glance.measure_gain(other) - now  # its velocity may move, as it will
            if gain > _BETTER and is_curve(glance.solve(hold_velocity(other, j)), j):
                gains.append((gain, other))
    return [other for _, other in sorted(gains, key=lambda pair: -pair[0])]


def _weigh_still(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> float:
    """Logarithm of the evidence of the curves where they stand; nothing where one is none."""
    model = fit.model
    for j, form in enumerate(model.forms):
        model = hold_velocity(model, j) if "stribeck" in form.names else model
    still = fit_arm(fit.arm, equations, model, prior, fit)
    falls = (is_curve(still, j) for j, form in enumerate(model.forms) if "stribeck" in form.names)
    return still.log_evidence if all(falls) else -np.inf


def is_curve(fit: ArmFit, joint: int) -> bool:
    """Whether the Stribeck curve of a joint falls with the speed, by no more than the level that it falls to.

    One that rises stands in for what else does; one that falls by more, over most of the speeds, is drag turned round.
    """
    excess = TERMS["stribeck"].names(dict(fit.model.forms[joint].terms)["stribeck"])[0]
    values = fit.friction(joint)
    return 0.0 < values[excess] <= values["coulomb"]


def _move_velocities(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior
) -> tuple[ArmFit, ArmEquations]:
    model = _free_velocities(fit.model)
    fit = fit if model == fit.model else fit_arm(fit.arm, equations, model, prior, fit)
    step = _find_steps(equations, fit)
    for _ in range(_ROUNDS):
        if not np.any(np.abs(step) > _STILL):
            break
        moved = equations.with_stribeck(rows, equations.stribeck * np.exp(step))
        there = fit_arm(fit.arm, moved, fit.model, prior, fit)
        if there.log_evidence > fit.log_evidence:
            fit, equations, step = there, moved, _find_steps(moved, there)
        else:
            step = 0.5 * step
    return fit, equations


def _find_steps(equations: ArmEquations, fit: ArmFit) -> FloatArray:
    """How far the logarithms of the velocities are from where the curves fit best. Shape as `equations.stribeck`."""
    steps = np.zeros_like(equations.stribeck)
    for j, form in enumerate(fit.model.forms):
        variant = dict(form.terms).get("stribeck")
        if variant is None:
            continue
        excess, _, width = (fit.friction(j)[name] for name in TERMS["stribeck"].names(variant))
        steps[j, variant] = np.clip(width / excess, -_STEP, _STEP) if excess > 0.0 else 0.0
    return steps
