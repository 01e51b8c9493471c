"""How well links and rotors are known beside a rotor that is held at none.

A rotor that came out below zero is held there, and torques then tell the sum of what it and its links weigh as if it
were that of the links alone: those of a slide that were two fifths too heavy in the simulation were told to be that,
and as well known as the sum. The rotor may be anything from none on, so that all is known as it is beside a free one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..prior import ArmPrior


def free_rotors(fit: ArmFit, equations: ArmEquations, prior: ArmPrior) -> ArmFit:
    """The fit with deviations beside rotors that may be anything.

    Args:
        fit: With deviations as its stretches show them.
        equations: Of all joints.
        prior: How far the simulation is trusted.
    """
    if not fit.model.rotorless:
        return fit
    models = fit.model, replace(fit.model, rotorless=frozenset())
    held, free = (fit_arm(fit.arm, equations, one, prior, fit, steps=0).covariance for one in models)
    factor: FloatArray = np.sqrt(np.maximum(1.0, np.diag(fit.covariance) / np.diag(held)))
    return replace(fit, covariance=free * np.outer(factor, factor))
