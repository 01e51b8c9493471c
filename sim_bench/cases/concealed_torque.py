"""The concealed torque as the recording shows it: from the joint, from the sensors, from what the user believes."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .dynamics import Motion
from .sensing import Sensors, distort_torque, lag_signal


def _compute_dry(v: NDArray[np.float64], fields: Mapping[str, float]) -> NDArray[np.float64]:
    """Dry level of the joint without effects [N·m]."""
    level = np.empty_like(v)
    for name, chosen in (("forward", v >= 0.0), ("reverse", v < 0.0)):
        coulomb, static = fields[f"coulomb_{name}"], fields[f"static_{name}"]
        level[chosen] = coulomb + (static - coulomb) * np.exp(-((v[chosen] / fields[f"stribeck_{name}"]) ** 2))
    return level


def _compute_viscous(v: NDArray[np.float64], fields: Mapping[str, float]) -> NDArray[np.float64]:
    return np.where(v >= 0.0, fields["viscous_forward"], fields["viscous_reverse"]) * v


def _compute_rigid_torque(motion: Motion, fields: Mapping[str, float]) -> NDArray[np.float64]:
    """Torque of a rigid joint with `fields` along the motion."""
    gravity = fields["gravity"] * np.sin(motion.position + fields["gravity_angle"])
    dry = motion.sense * _compute_dry(motion.velocity, fields)
    return np.asarray(
        fields["inertia"] * motion.acceleration + gravity + dry + _compute_viscous(motion.velocity, fields)
    )


def _decentre_motion(motion: Motion, fields: Mapping[str, float]) -> Motion:
    """The motion as an eccentric encoder shows it."""
    order = fields["eccentricity_order"]
    angle = order * motion.position + fields["eccentricity_phase"]
    error = fields["eccentricity"] * np.sin(angle)
    slope = fields["eccentricity"] * order * np.cos(angle)
    bend = -fields["eccentricity"] * order**2 * np.sin(angle)
    return motion._replace(
        position=motion.position + error,
        velocity=motion.velocity * (1.0 + slope),
        acceleration=motion.acceleration * (1.0 + slope) + bend * motion.velocity**2,
    )


def _lag_motion(motion: Motion, sensors: Sensors) -> Motion:
    """The motion with the speed of a lagging velocity channel."""
    return motion._replace(velocity=lag_signal(motion.velocity, sensors.velocity_lag))


def compute_concealed(
    motion: Motion, sensors: Sensors, fields: Mapping[str, float], belief: Mapping[str, float]
) -> NDArray[np.float64]:
    """Noise-free torque that the believed joint cannot explain along the measured motion [N·m], shape (n_samples,).

    Args:
        motion: The true one.
        sensors: With the effects of measurement.
        fields: Of the plant.
        belief: Fields that the user's simulation has otherwise.
    """
    seen = motion
    if fields.get("eccentricity", 0.0):
        seen = _decentre_motion(seen, fields)
    if sensors.velocity_lag > 0.0:
        seen = _lag_motion(seen, sensors)
    concealed = motion.concealed + distort_torque(motion.torque, sensors) - motion.torque
    if seen is not motion:
        concealed = concealed - (_compute_rigid_torque(seen, fields) - _compute_rigid_torque(motion, fields))
    if belief:
        concealed = (
            concealed + _compute_rigid_torque(motion, fields) - _compute_rigid_torque(motion, {**fields, **belief})
        )
    return np.asarray(concealed)
