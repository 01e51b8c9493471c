"""What friction cannot do: feed energy in, or hold more in a bristle than it has when it slides."""

from __future__ import annotations

import numpy as np

from .fit import ArmFit

__all__ = ["is_physical"]

_SURE = 2.0
"""Standard deviations by which a parameter must be on the wrong side."""


def is_physical(fit: ArmFit) -> bool:
    """Whether the friction of every joint can exist."""
    return all(_can_exist(fit, j) for j in range(len(fit.arm.joints)))


def _can_exist(fit: ArmFit, joint: int) -> bool:
    place, names = fit.find_friction(joint)
    values, covariance = fit.x[place], fit.covariance[place, place]
    short = {name.rsplit(".", 1)[0] if "." in name else name: k for k, name in enumerate(names)}

    def is_positive(**weights: float) -> bool:
        direction = np.zeros(len(names))
        for name, weight in weights.items():
            at = short.get(name.replace("__", "."))
            if at is not None:
                direction[at] = weight
        value, spread = float(direction @ values), float(np.sqrt(direction @ covariance @ direction))
        return value >= -_SURE * spread

    return (
        is_positive(coulomb=1.0)
        and is_positive(stribeck__excess=1.0)
        and is_positive(load_coulomb__coefficient=1.0)
        and is_positive(load_quadratic__coefficient=1.0)
        and is_positive(presliding_hysteresis__level=1.0)
        and is_positive(coulomb=1.0, presliding_hysteresis__level=-1.0)
        and is_positive(quadratic_drag__coefficient=1.0)
        and is_positive(spring_torque__stiffness=1.0)
        and is_positive(power_law_viscous__torque_at_top_speed=1.0)
    )
