"""What the priors of an arm's parameters are measured in, as the simulation and the recording have it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fricomp.laws import FloatArray

from ..friction import PLAIN, TERMS
from ..rigid.inertia import N_INERTIA
from ..rigid.simulated_arm import SimulatedArm
from .arm_prior import ArmPrior

_WARMTH = 10.0
"""[K] over which friction may change by all of its prior: joints at work get that much warmer."""

_LEAST_LEVEL = 1e-3
"""Of a joint's widest friction torque, that its Coulomb level is taken to have at least."""

HELD_PART = 1e-6
"""Prior deviation of friction that is held at zero, as part of what it is otherwise: models are weighed from where it
is not held."""

_WHOLE = frozenset(term.name for term in TERMS.values() if term.whole)
"""Terms whose one parameter is a share that should be one."""


@dataclass(frozen=True)
class TorqueSizes:
    """What is seen of each joint, whatever is fitted. Shapes (n_joints,).

    Attributes:
        rotor: All that the torques allow a rotor beside what is stated [kg·m²] or [kg].
        torque: RMS of its torque [N·m] or [N].
        level: Coulomb friction beside the simulated torque [N·m] or [N].
        speed: Top speed [rad/s] or [m/s].
    """

    rotor: FloatArray
    torque: FloatArray
    level: FloatArray
    speed: FloatArray


def measure_torques(arm: SimulatedArm, sums: FloatArray, top_speed: FloatArray) -> TorqueSizes:
    """What is seen of each joint.

    Args:
        arm: The simulation.
        sums: As those of `ArmEquations`.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
    """
    n = N_INERTIA * len(arm.links)
    squares = np.maximum(sums[:, n, n], 1e-12)  # of the acceleration
    ones = np.maximum(sums[:, n + 2, n + 2], 1.0)  # of the column of the offset
    return TorqueSizes(
        rotor=arm.armature + np.sqrt(sums[:, -1, -1] / squares),
        torque=np.sqrt(np.maximum(sums[:, -1, -1] / ones, 1e-18)),
        level=_guess_levels(arm, sums),
        speed=top_speed,
    )


@dataclass(frozen=True)
class PriorSizes:
    """What the prior of each joint is measured in. Shapes (n_joints,).

    Attributes:
        rotor: A rotor's inertia as far as it may be off: all that is stated and that the torques allow [kg·m²] or [kg].
        torque: A friction torque as wide as the prior lets it be [N·m] or [N].
        level: Coulomb friction beside the simulated torque [N·m] or [N].
        speed: Top speed [rad/s] or [m/s].
    """

    rotor: FloatArray
    torque: FloatArray
    level: FloatArray
    speed: FloatArray

    @classmethod
    def of(cls, seen: TorqueSizes, prior: ArmPrior) -> PriorSizes:
        """As far as a prior trusts the simulation."""
        torque = prior.friction * seen.torque
        level = np.maximum(seen.level, _LEAST_LEVEL * torque)
        return cls(np.maximum(prior.rotors * seen.rotor, 1e-9), torque, level, seen.speed)


def size_friction(
    sizes: PriorSizes, prior: ArmPrior, joint: int, names: tuple[str, ...], pinned: Collection[tuple[int, str]]
) -> FloatArray:
    """Prior deviations of friction parameters of one joint, by their names. Shape (len(names),)."""
    typical, speed, level = float(sizes.torque[joint]), float(sizes.speed[joint]), float(sizes.level[joint])
    free = _size_columns(names, typical, speed, level, prior)
    return free * [HELD_PART if (joint, name) in pinned else 1.0 for name in names] if pinned else free


def _guess_levels(arm: SimulatedArm, sums: FloatArray) -> FloatArray:
    """Coulomb level of each joint beside its simulated torque times a factor [N·m] or [N]."""
    n, last = arm.inertia.size, arm.inertia.size + 1 + len(PLAIN)
    some = np.zeros((len(sums), last, 1 + len(PLAIN)))
    some[:, :n, 0], some[:, n, 0] = arm.inertia.ravel(), arm.armature
    some[:, n + 1 :, 1:] = np.eye(len(PLAIN))
    across = np.swapaxes(some, 1, 2)
    whole, pull = across @ (sums[:, :last, :last] @ some), across @ sums[:, :last, -1:]
    found = (np.linalg.pinv(whole, hermitian=True) @ pull)[:, 1 + PLAIN.index("coulomb"), 0]
    return np.abs(found)


@lru_cache(maxsize=4096)
def _size_columns(names: tuple[str, ...], torque: float, speed: float, level: float, prior: ArmPrior) -> FloatArray:
    """Prior deviations of friction parameters, as those of `_size_column`; some follow the Coulomb level [N·m]."""
    by_level = {"stribeck": prior.stribeck * level, "spring_torque": prior.spring * level}
    sizes = [by_level.get(name.split(".")[0], 0.0) or _size_column(name, torque, speed, prior) for name in names]
    result = np.array(sizes)
    result.flags.writeable = False
    return result


def _size_column(name: str, torque: float, speed: float, prior: ArmPrior) -> float:
    """Prior deviation of a friction parameter, from a typical torque [N·m] and the joint's top speed [rad/s]."""
    if name.startswith("torque_delay"):
        return prior.delay
    if name.partition(".")[0] in _WHOLE:
        return 1.0
    if name.startswith("torque_gain_error"):
        return prior.gain
    if name.startswith("thermal_friction"):
        return torque / _WARMTH / (speed if ".viscous" in name else 1.0)
    if name.startswith("load_coulomb"):
        return prior.load_friction
    if name.startswith("load_quadratic"):
        return prior.load_friction / max(torque / prior.friction, 1e-9)
    if name.startswith("viscous"):
        return torque / speed
    return torque / speed**2 if name.startswith("quadratic_drag") else torque
