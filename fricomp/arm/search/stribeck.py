"""The Stribeck velocity of each joint: it moves along the slope of its curve to where the curve fits best."""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import TERMS
from ..prior import ArmPrior
from ..rows import ArmRows

__all__ = ["refine_stribeck"]

_ROUNDS = 6
"""Of moving all velocities; each leaves about the square of the distance before."""

_STEP = 0.5
"""Longest step of a velocity's logarithm."""

_STILL = 0.02
"""Step of a velocity's logarithm below which it stands still."""


def refine_stribeck(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior
) -> tuple[ArmFit, ArmEquations]:
    """Move the Stribeck velocities of a fit, as long as that makes the recording more probable.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
    """
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
