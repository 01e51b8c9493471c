"""A fit in which rows count by what it leaves of them."""

from __future__ import annotations

from .coordinates import ArmModel
from .equations import ArmEquations
from .fit import ArmFit, fit_arm
from .physics import hold_at_zero
from .prior import ArmPrior
from .rigid.simulated_arm import SimulatedArm
from .rows import ArmRows
from .search.ripple import refine_ripples
from .search.stribeck import refine_stribeck

_REWEIGHTINGS = 2
"""Rounds of weighing rows by what a fit leaves of them."""


def fit_robustly(
    arm: SimulatedArm,
    rows: ArmRows,
    equations: ArmEquations,
    model: ArmModel,
    prior: ArmPrior,
    start: ArmFit | None = None,
    *,
    settled: bool = False,
) -> tuple[ArmFit, ArmEquations]:
    """A fit in which rows count by what it leaves of them, and friction follows the load that it finds.

    Args:
        arm: The simulation.
        rows: Motion and torques.
        equations: Of these rows, with whatever weights and load.
        model: What is fitted.
        prior: How far the simulation is trusted.
        start: A fit to begin with.
        settled: Nothing more is taken in: rows near a reversal count by what is left of them, no rotor's inertia is
            below zero, and no viscous friction. While terms are chosen they may be, since what pulls them there would
            pull at the terms.
    """
    fit = fit_arm(arm, equations, model, prior, start)
    for _ in range(_REWEIGHTINGS):
        fresh = equations.with_links(rows, fit.compute_load(rows), fit.inertia)
        equations = fresh.with_residuals(fit.residuals(fresh), rows, settled=settled)
        fit = fit_arm(arm, equations, model, prior, fit)
    fit, equations = refine_ripples(rows, equations, fit, prior)
    fit, equations = refine_stribeck(rows, equations, fit, prior)
    held = hold_at_zero(fit) if settled else fit.model
    if held == fit.model:
        return fit, equations
    return fit_robustly(arm, rows, equations, held, prior, fit, settled=settled)
