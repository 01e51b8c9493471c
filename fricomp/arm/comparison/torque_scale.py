"""Torques and friction in true units, where those that were recorded have a wrong scale.

    tau_recorded = (1 + g) (1 + eps_j) tau

The fit describes what was recorded: friction and rotor of a joint whose torque is recorded a quarter too large come out
a quarter too large as well, beside links that are right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.diagnosis.record.result import Quantity
from fricomp.recording import Recording

from ..fit import Z95, ArmFit
from ..friction import TERMS

_FREE = ("torque_gain_error", "torque_delay", "backlash", "joint_elasticity")
"""Terms whose parameters are no torques of the joint."""


def find_own_scale(fit: ArmFit, joint: int) -> tuple[float, float]:
    """Factor that a joint's torques were recorded with beside those of the others, and its standard deviation."""
    (name,) = TERMS["torque_gain_error"].names(0)
    place, names = fit.find_friction(joint)
    if name not in names:
        return 1.0, 0.0
    at = place.start + names.index(name)
    return 1.0 + float(fit.x[at]), float(np.sqrt(fit.covariance[at, at]))


def scale_values(fit: ArmFit, joint: int, values: Mapping[str, float]) -> dict[str, float]:
    """Friction parameters of a joint in true torque, from those of recorded torque."""
    scale, _ = find_own_scale(fit, joint)
    return {name: value if name.startswith(_FREE) else value / scale for name, value in values.items()}


def scale_quantities(fit: ArmFit, joint: int, values: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """The same with intervals, which are as wide as the scale is unknown besides."""
    scale = find_own_scale(fit, joint)
    return {name: one if name.startswith(_FREE) else scale_quantity(one, scale) for name, one in values.items()}


def scale_quantity(quantity: Quantity, scale: tuple[float, float]) -> Quantity:
    """A quantity over a factor that is known to a standard deviation."""
    factor, deviation = scale
    if scale == (1.0, 0.0):
        return quantity
    value, more = quantity.value / factor, Z95 * quantity.value * deviation / factor**2
    low, high = (np.hypot(end / factor - value, more) for end in quantity.ci95)
    return Quantity(value, quantity.unit, (value - float(low), value + float(high)), at_bound=quantity.at_bound)


def scale_recordings(fit: ArmFit, recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """The recordings of all joints with true torques, in the order of the joints."""
    scales = find_scales(fit)
    return tuple(
        one if scale == 1.0 else one.with_channels(torque=np.asarray(one.torque) / scale)
        for one, scale in zip(recordings, scales, strict=True)
    )


def find_scales(fit: ArmFit) -> list[float]:
    """Factor that the torques of each joint were recorded with, in all."""
    shared = fit.gain[0] if fit.model.gain else 1.0
    return [shared * find_own_scale(fit, j)[0] for j in range(len(fit.arm.joints))]
