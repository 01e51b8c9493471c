"""The base model: what a rigid joint with bidirectional Stribeck friction has, as a vector of numbers to fit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..inputs.rigid import RigidJoint
from ..inputs.track import FloatArray
from .observer import Plant
from .settings import JOINT
from .solver import Box

BASE_NAMES = (
    "log_inertia",
    "gravity_cos",
    "gravity_sin",
    "offset",
    "forward.coulomb_torque",
    "forward.excess",
    "forward.log_stribeck_velocity",
    "forward.viscous_coefficient",
    "reverse.coulomb_torque",
    "reverse.excess",
    "reverse.log_stribeck_velocity",
    "reverse.viscous_coefficient",
    "log_breakaway",
    "delay",
    "damping_time",
    "sharpness",
    "log_spread",
    "creep_velocity",
    "creep_lead",
)

BODY_AND_CURVES = BASE_NAMES.index("log_breakaway")
"""Parameters before it are inertia, gravity, offset and the curves of both directions."""


_CURVE = ("coulomb_torque", "excess", "log_stribeck_velocity", "viscous_coefficient")
_FALL = ("excess", "log_stribeck_velocity")  # how friction falls with speed


def pack(plant: Plant) -> FloatArray:
    """The numbers of `plant`, in the order of `BASE_NAMES`."""
    values = [np.log(plant.inertia), *plant.gravity, plant.offset]
    for coulomb, static, velocity, viscous in (plant.forward, plant.reverse):
        values += [coulomb, static - coulomb, np.log(velocity), viscous]
    return np.array(
        [
            *values,
            np.log(plant.bristle_level / plant.sigma_0),
            plant.delay,
            plant.sigma_1 / plant.sigma_0,
            plant.sharpness,
            np.log(plant.spread),
            plant.creep_velocity,
            plant.creep_lead,
        ]
    )


def unpack(theta: FloatArray) -> Plant:
    """The plant that `theta` describes."""
    f, r = theta[4:8], theta[8:12]
    plant = Plant(
        inertia=float(np.exp(theta[0])),
        gravity=(float(theta[1]), float(theta[2])),
        offset=float(theta[3]),
        forward=(float(f[0]), float(f[0] + f[1]), float(np.exp(f[2])), float(f[3])),
        reverse=(float(r[0]), float(r[0] + r[1]), float(np.exp(r[2])), float(r[3])),
        sigma_0=1.0,  # it follows from the curves
        delay=float(theta[13]),
        sharpness=float(theta[15]),
        spread=float(np.exp(theta[16])),
        creep_velocity=float(theta[17]),
        creep_lead=float(theta[18]),
    )
    sigma_0 = max(plant.bristle_level, 1e-9) / float(np.exp(theta[12]))
    return replace(plant, sigma_0=sigma_0, sigma_1=sigma_0 * float(theta[14]))


def even_directions(theta: FloatArray) -> FloatArray | None:
    """Put the difference of the directions into the offset; None where there is hardly any. Shape (p,).

    Sliding shows their sum alone. What a wrong bristle or an effect that was missed has parted stays so: the way back
    is a valley along which next to nothing is gained.
    """
    forward, reverse, offset = (
        BASE_NAMES.index(n) for n in ("forward.coulomb_torque", "reverse.coulomb_torque", "offset")
    )
    difference = theta[forward] - theta[reverse]
    if abs(difference) < JOINT.uneven_share * unpack(theta[: len(BASE_NAMES)]).level:
        return None
    result = theta.copy()
    result[[forward, reverse, offset]] += [-0.5 * difference, 0.5 * difference, 0.5 * difference]
    return result


def align_falls(theta: FloatArray) -> FloatArray | None:
    """Let friction fall with speed in both directions as it does in one of them; None where they are alike. Shape (p,).

    In a direction whose start of motion a wrong bristle had wrong, the static friction is lost or the Stribeck
    velocity has run away: the way back leads uphill. The direction to go by is the one that has static friction, or
    the one with the lower Stribeck velocity where both have.
    """
    forward, reverse = ([BASE_NAMES.index(f"{side}.{name}") for name in _FALL] for side in ("forward", "reverse"))
    less, more = sorted((forward, reverse), key=lambda side: theta[side[0]])
    low, high = sorted((forward, reverse), key=lambda side: theta[side[1]])
    if theta[less[0]] < JOINT.lost_fall * theta[more[0]]:
        low, high = more, less
    elif theta[high[1]] - theta[low[1]] < JOINT.unlike_stribeck:
        return None
    result = theta.copy()
    result[high] = theta[low]
    return result


def straighten_curves(theta: FloatArray, usual_speed: float) -> FloatArray | None:
    """Let friction fall at low speeds only, and be a line beyond; None where it does. Shape (p,).

    A fall as wide as the motion is fast has taken the place of the Coulomb torque beside too much viscous drag, in
    which a wrong law of presliding had left room for it. What it bends there, effects would explain.

    Args:
        theta: Base parameters, and perhaps those of effects. Shape (p,).
        usual_speed: That the motion hardly exceeds [rad/s] or [m/s].
    """
    result = theta.copy()
    for side in ("forward", "reverse"):
        at = [BASE_NAMES.index(f"{side}.{name}") for name in _CURVE]
        coulomb, excess, width, viscous = theta[at]
        if excess < JOINT.wide_excess * coulomb or width < np.log(JOINT.wide_fall * usual_speed):
            continue
        speed = np.linspace(JOINT.wide_fall, 1.0, 20) * usual_speed
        curve = coulomb + excess * np.exp(-((speed / np.exp(width)) ** 2)) + viscous * speed
        slope, level = np.polyfit(speed, curve, 1)
        level, slope = (level, slope) if slope > 0.0 else (float(np.mean(curve)), 0.0)
        result[at] = level, max(coulomb + excess - level, 0.0), np.log(0.5 * JOINT.wide_fall * usual_speed), slope
    return result if not np.array_equal(result, theta) else None


def is_at_latest(plant: Plant, latest: float) -> bool:
    """Whether the torque comes about as late as the base allows, so that a longer delay may hide behind it."""
    return plant.delay > JOINT.at_bound_share * latest


def is_at_earliest(plant: Plant, earliest: float) -> bool:
    """Whether the torque comes about as early as the base allows, so that a lag may hide behind it."""
    return plant.delay < JOINT.at_bound_share * earliest


@dataclass(frozen=True)
class BaseModel:
    """Domain of the base parameters around a first estimate.

    Attributes:
        start: First estimate.
        box: Bounds, scales and weak priors. Their unit is one standard deviation of a residual row.
    """

    start: FloatArray
    box: Box

    @classmethod
    def build_around(
        cls,
        plant: Plant,
        *,
        delays: tuple[float, float],
        top_speed: float,
        torques: tuple[float, float],
        rotary: bool,
        known: RigidJoint | None = None,
    ) -> BaseModel:
        """Build the domain around a first estimate of the plant.

        What is missing may have bent that estimate to nearly no friction, or to more than the drive could overcome:
        how much friction there may be is a matter of the recorded torque.

        Args:
            plant: The first estimate.
            delays: Earliest and latest that a torque without any flaw comes [s].
            top_speed: Of the recordings [rad/s] or [m/s].
            torques: Typical and largest size of the recorded torque [N·m].
            rotary: Whether gravity depends on the sine of the position.
            known: Inertia and gravity of a simulation, which bind it weakly.
        """
        typical, largest = torques
        level = max(min(plant.level, largest), JOINT.least_level * typical, 1e-6)
        viscous = max(plant.forward[3], plant.reverse[3], 0.1 * level / top_speed)
        size = max(float(np.hypot(*plant.gravity)), level)
        gravity_free = 100.0 * size if rotary else 0.0
        breakaway = np.log((JOINT.stiffest_bristle, JOINT.softest_bristle))
        start = pack(
            replace(
                plant,
                sigma_0=plant.bristle_level / JOINT.usual_bristle,
                delay=0.5 * sum(delays),
                sharpness=0.5,
            )
        )
        friction_low = [0.0, 0.0, np.log(top_speed * JOINT.lowest_stribeck), 0.0]
        fastest = max(50 * viscous, largest / top_speed)
        friction_high = [min(50 * level, max(largest, level)), 10 * level, np.log(top_speed), fastest]
        friction_scale = [0.1 * level, 0.1 * level, 0.3, 0.2 * viscous]
        inertia = start[0]
        lower = [inertia - 3, -gravity_free, -gravity_free, -100 * size, *friction_low, *friction_low, breakaway[0]]
        upper = [inertia + 3, gravity_free, gravity_free, 100 * size, *friction_high, *friction_high, breakaway[1]]
        scale = [0.05, 0.05 * size, 0.05 * size, 0.05 * level, *friction_scale, *friction_scale, 0.3]
        reach = 0.5 * (delays[1] - delays[0])
        bristle_scale = [0.5 * reach, 0.2 * JOINT.largest_damping_time, 0.3, 0.5, JOINT.held_scale, JOINT.held_scale]
        low = np.array([*lower, delays[0], 0.0, 0.0, 0.0, 0.0, 0.0])
        high = np.array([*upper, delays[1], JOINT.largest_damping_time, 1.0, 1.5, 0.0, 0.0])
        centre = start.copy()
        centre[4] = centre[8] = level
        weight = np.zeros(start.size)
        if known is not None:
            weight[0] = 1.0 / known.error
            centre[1:3] = known.gravity
            weight[1:3] = 1.0 / (known.error * max(float(np.hypot(*known.gravity)), level))
        for i in (6, 10):
            centre[i] = np.log(0.05 * top_speed)
            weight[i] = 1.0 / 1.5
        weight[12] = 1.0 / 1.5
        weight[13] = 1.0 / reach
        weight[14] = 1.0 / (0.5 * JOINT.largest_damping_time)
        weight[15] = 1.0 / 0.5
        centre[15] = 0.5
        weight[16] = 1.0 / 0.7
        # Sliding shows offset and difference of the directions as one sum; only the start of motion could part them.
        # A friction that hardly falls within the motion is as good a level as the Coulomb torque.
        unit = np.eye(start.size) / (JOINT.asymmetry_spread * level)
        differences = (unit[4] - unit[8], unit[4] + unit[5] - unit[8] - unit[9])
        precision = np.diag(weight**2) + sum(np.outer(one, one) for one in differences)
        return cls(
            np.clip(start, low, high),
            Box(low, high, np.array([*scale, *bristle_scale]), centre, precision, np.array(JOINT.longest_steps)),
        )
