"""The compensation over arrays: the same equation as the hot path, for simulating many cases at once."""

import numpy as np

from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.settings import CompensationSettings
from fricomp.laws import FloatArray


def compute_friction(curves: FrictionCurves, velocity: FloatArray) -> FloatArray:
    """Friction torque in steady sliding, zero at rest [N·m] or [N]."""
    speed = np.abs(velocity)
    ahead = curves.forward.dry(speed) + curves.forward.viscous * speed
    back = curves.reverse.dry(speed) + curves.reverse.viscous * speed
    return np.where(velocity > 0.0, ahead, np.where(velocity < 0.0, -back, 0.0))


def compute_compensation(
    curves: FrictionCurves,
    settings: CompensationSettings,
    velocity_reference: FloatArray,
    velocity: FloatArray,
    position_error: FloatArray | None = None,
) -> FloatArray:
    """Compensation with unit gain and without limits of authority and rate; the equation of `CompensationSettings`.

    Args:
        curves: A static law.
        settings: Gain, authority and rate in it are not applied.
        velocity_reference: Shape (n,) or anything that broadcasts with it [rad/s] or [m/s].
        velocity: Measured, likewise [rad/s] or [m/s].
        position_error: Reference minus measured position, likewise [rad] or [m].
    """
    share, drive = settings.measured_share, velocity_reference
    if settings.source == "measured":
        drive = np.sign(velocity) * np.maximum(np.abs(velocity) - settings.dead_band, 0.0)
    direction = drive
    if position_error is not None and settings.error_rate:
        beyond = np.maximum(np.abs(position_error) - settings.error_band, 0.0)
        direction = drive + settings.error_rate * np.sign(position_error) * beyond
    ahead = direction >= 0.0
    speed = np.maximum(np.where(ahead, 1.0, -1.0) * ((1.0 - share) * drive + share * velocity), 0.0)
    dry = np.where(ahead, curves.forward.dry(speed), curves.reverse.dry(speed))
    if settings.rest_velocity:
        rest = np.maximum(1.0 - np.abs(velocity) / settings.rest_velocity, 0.0)
        static = np.where(ahead, sum(curves.forward[:2]), sum(curves.reverse[:2]))
        dry = dry + rest * (static - dry)
    viscous = np.where(ahead, curves.forward.viscous, curves.reverse.viscous)
    torque = dry * np.tanh(direction / settings.smoothing) + viscous * drive
    low, high = settings.velocity_range
    outside = np.maximum(drive - high, low - drive)
    return np.asarray(torque * np.clip(1.0 - outside / settings.fade_width, 0.0, 1.0), dtype=np.float64)
