"""What no joint can be like: the floor below which a model is never usable, whoever fitted it."""

import numpy as np
from numpy.typing import ArrayLike

from fricomp.model.model import FrictionModel

_SURE = 2.0
"""Standard deviations below zero from which on an inertia is negative."""
_FED = 0.05
"""Part of the speeds at which friction may come out as driving; next to rest an offset does that."""
_SPEEDS = 50
"""Speeds at which the friction is looked at."""


def find_impossible(
    model: FrictionModel, velocity: ArrayLike, inertia: tuple[float, float] | None = None
) -> str | None:
    """Why no joint can be like `model`, with what to do; None where one can.

    Identification, calibration and diagnosis ask this of every model before it may be used.

    Args:
        model: Friction.
        velocity: Speeds at which it was measured [rad/s] or [m/s]. Shape (n,).
        inertia: Value and standard deviation of the inertia that was fitted beside it [kg·m²] or [kg]; None where none
            was.
    """
    check = "check the sign, the unit and the time of the torque, and whether something else moves the joint"
    if inertia is not None and inertia[0] < -_SURE * inertia[1]:
        return (
            f"the inertia comes out negative ({inertia[0]:.3g} ± {inertia[1]:.2g}), which no joint has: {check}, or "
            "whether it gives like a spring, by presliding or elasticity ('fricomp diagnose' tells)"
        )
    drag = {name: value for name, value in model.law.parameters().items() if name.endswith("viscous_coefficient")}
    for name, value in drag.items():
        if value < 0.0:
            return f"{name} comes out negative ({value:.3g}), and viscous friction brakes: {check}"
    if _share_of_driving(model, velocity) > _FED:
        said = "the friction would drive the joint at some of the speeds that were measured, which none does"
        return f"{said}: check the sign and the offset of the torque"
    return None


def _share_of_driving(model: FrictionModel, velocity: ArrayLike) -> float:
    """Part of the speeds, in both directions, at which the friction has not the sign of the velocity."""
    values = np.asarray(velocity, dtype=np.float64)
    sliding = np.abs(values[values != 0.0])
    if not sliding.size:
        return 0.0
    speeds = np.quantile(sliding, np.linspace(0.02, 1.0, _SPEEDS))
    both = np.concatenate([-speeds, speeds])
    return float(np.mean(np.asarray(model.torque(both), dtype=np.float64) * both < 0.0))
