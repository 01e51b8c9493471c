"""One joint's inertia, gravity, offset and friction from a recorded motion, by filtered regression.

Torque and regressors pass through the same low-pass filter and are decimated together [gautier1997filtering], so the
filter cancels; position is differentiated after a zero-phase low-pass. Friction is then refined on what the rigid
body leaves of the torque.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .identification import IdentificationOptions, IdentificationResult, identify
from .motion_parts import MotionParts, split_motion

__all__ = ["JointSamples", "MotionIdentification", "RegressionSettings", "RigidBodyFit", "fit_rigid_body",
           "identify_motion", "prediction_error", "sample_joint", "split_for"]  # fmt: skip


@dataclass(frozen=True)
class RegressionSettings:
    """How a recording is filtered.

    Attributes:
        position_cutoff: Low-pass of the position before it is differentiated [Hz].
        torque_cutoff: Low-pass of torque and regressors; samples are decimated to five times it [Hz].
        gravity: Whether gravity acts (a cosine and a sine of the position).
        slowest: Samples below this fraction of the top speed are left out of the friction curve.
        margin: Time left out at both ends, where filters start; around gaps too [s].
    """

    position_cutoff: float = 60.0
    torque_cutoff: float = 50.0
    gravity: bool = False
    slowest: float = 0.01
    margin: float = 0.05


_DEFAULTS = RegressionSettings()
_FEWEST_SAMPLES = 200


@dataclass(frozen=True)
class JointSamples:
    """Filtered, decimated samples.

    Attributes:
        position: [rad] or [m]. Shape (n,).
        velocity: [rad/s] or [m/s]. Shape (n,).
        acceleration: [rad/s²] or [m/s²]. Shape (n,).
        direction: Low-passed sign of the velocity; between -1 and 1 near a reversal. Shape (n,).
        torque: [N·m], [N] or the recording's unit. Shape (n,).
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    torque: FloatArray

    def between(self, begin: float, end: float) -> JointSamples:
        """The part from `begin` to `end`, as fractions of the whole."""
        n = len(self.torque)
        part = slice(round(begin * n), round(end * n))
        return JointSamples(*(getattr(self, name)[part] for name in vars(self)))


@dataclass(frozen=True)
class RigidBodyFit:
    """torque = inertia a + F_v v + F_c sgn(v) + offset + g_c cos(q) + g_s sin(q)

    Attributes:
        inertia: [kg·m²] or [kg].
        viscous_coefficient: [N·m·s/rad] or [N·s/m].
        coulomb_torque: [N·m] or [N].
        offset: [N·m] or [N].
        gravity: g_c and g_s [N·m]; zeros where gravity was not fitted.
        standard_deviations: Of inertia, viscous coefficient, Coulomb torque and offset, residuals taken as white.
        residual: Root mean square of what is left, as a fraction of the torque's.
    """

    inertia: float
    viscous_coefficient: float
    coulomb_torque: float
    offset: float
    gravity: tuple[float, float]
    standard_deviations: tuple[float, ...]
    residual: float

    def rigid_torque(self, samples: JointSamples) -> FloatArray:
        """Torque of inertia, gravity and offset. Shape (n,)."""
        g_c, g_s = self.gravity
        gravity = g_c * np.cos(samples.position) + g_s * np.sin(samples.position)
        return np.asarray(self.inertia * samples.acceleration + self.offset + gravity)


@dataclass(frozen=True)
class MotionIdentification:
    """A joint identified from a recorded motion.

    Attributes:
        rigid_body: Inertia, gravity and offset, with the symmetric friction fitted beside them.
        friction: The friction law fitted to what they leave.
        points: Friction points behind it: velocity and torque. Shape (n, 2).
    """

    rigid_body: RigidBodyFit
    friction: IdentificationResult
    points: FloatArray


def sample_joint(recording: Recording, settings: RegressionSettings = _DEFAULTS) -> JointSamples:
    """Filter and decimate a recording, each part between gaps on its own: nothing is known of the motion in a gap.

    Raises:
        IdentificationError: The recording is too short for the filters.
    """
    rate = 1.0 / recording.sample_period
    times = [np.arange(part.time[0], part.time[-1], 1.0 / rate) for part in split_for(recording, settings).parts]
    count = sum(map(len, times))
    if count < _FEWEST_SAMPLES:
        raise IdentificationError(
            f"a motion needs at least {_FEWEST_SAMPLES} samples between gaps, this one has {count}"
        )
    parts = [_filter(even, recording, rate, settings) for even in times]
    return JointSamples(*np.concatenate(parts, axis=1))


def split_for(recording: Recording, settings: RegressionSettings = _DEFAULTS) -> MotionParts:
    """The parts of a recording that are filtered; gaps below half a period of the position's cutoff are bridged."""
    return split_motion(recording, shortest_gap=0.5 / settings.position_cutoff, margin=settings.margin)


def _filter(even: FloatArray, recording: Recording, rate: float, settings: RegressionSettings) -> FloatArray:
    """The columns of `JointSamples` for one part without gaps.

    Args:
        even: Times at the recording's rate [s]. Shape (n,).
        recording: What is sampled at them.
        rate: [Hz].
        settings: Cutoffs and margin.
    """
    position = np.interp(even, recording.time, recording.position)
    torque = np.interp(even, recording.time, recording.torque)
    low_pass = butter(4, min(settings.position_cutoff, 0.4 * rate), fs=rate, output="sos")
    smooth = sosfiltfilt(low_pass, position)
    velocity = np.gradient(smooth, 1.0 / rate)
    acceleration = np.gradient(velocity, 1.0 / rate)
    factor = max(1, int(rate / (5.0 * settings.torque_cutoff)))
    columns = np.stack([smooth, velocity, acceleration, np.sign(velocity), torque])
    final = butter(4, min(settings.torque_cutoff, 0.4 * rate), fs=rate, output="sos")
    filtered = sosfiltfilt(final, columns, axis=1)[:, ::factor]
    skip = max(1, int(settings.margin * rate / factor))
    return np.asarray(filtered[:, skip:-skip])


def fit_rigid_body(samples: JointSamples, *, gravity: bool = False) -> RigidBodyFit:
    """Least squares for inertia, symmetric Coulomb and viscous friction, offset, and gravity if asked.

    Raises:
        IdentificationError: The motion does not excite all of them.
    """
    columns = [samples.acceleration, samples.velocity, samples.direction, np.ones_like(samples.torque)]
    if gravity:
        columns += [np.cos(samples.position), np.sin(samples.position)]
    regressors = np.stack(columns, axis=1)
    scale = np.maximum(np.linalg.norm(regressors, axis=0), 1e-12)
    solution, _, rank, _ = np.linalg.lstsq(regressors / scale, samples.torque, rcond=1e-8)
    if rank < regressors.shape[1]:
        raise IdentificationError(
            "the motion does not tell inertia, friction and gravity apart: "
            "record one with several speeds and both directions"
        )
    error = samples.torque - regressors / scale @ solution
    variance = float(error @ error) / (len(error) - rank)
    covariance = variance * np.linalg.inv((regressors / scale).T @ (regressors / scale)) / np.outer(scale, scale)
    values = solution / scale
    g = (float(values[4]), float(values[5])) if gravity else (0.0, 0.0)
    deviations = tuple(np.sqrt(np.diag(covariance))[:4].tolist())
    residual = float(np.sqrt(np.mean(error**2) / np.mean(samples.torque**2)))
    inertia, viscous, coulomb, offset = values[:4].tolist()
    return RigidBodyFit(inertia, viscous, coulomb, offset, g, deviations, residual)


def identify_motion(
    samples: JointSamples,
    settings: RegressionSettings = _DEFAULTS,
    *,
    law: str = "stribeck",
    options: IdentificationOptions | None = None,
) -> MotionIdentification:
    """Identify rigid body and friction from filtered samples.

    Samples near a reversal, where filters mix both directions, are left out of the friction curve.

    Raises:
        IdentificationError: The motion does not tell the parts apart.
    """
    rigid = fit_rigid_body(samples, gravity=settings.gravity)
    top = float(np.max(np.abs(samples.velocity)))
    sliding = (np.abs(samples.direction) > 0.98) & (np.abs(samples.velocity) > settings.slowest * top)
    velocity = samples.velocity[sliding]
    friction = (samples.torque - rigid.rigid_torque(samples))[sliding]
    result = identify(velocity, friction, noise="absolute", law=law, options=options or IdentificationOptions())
    return MotionIdentification(rigid, result, np.stack([velocity, friction], axis=1))


def prediction_error(fit: MotionIdentification, samples: JointSamples, model: FrictionModel | None = None) -> float:
    """Root mean square error of the predicted torque, as a fraction of the torque's.

    Args:
        fit: What was identified, on other data.
        samples: Data it did not see.
        model: A friction model in place of the fit's.
    """
    friction = np.asarray((model or fit.friction.model).torque(np.asarray(samples.velocity)))
    friction = np.abs(friction) * samples.direction
    error = samples.torque - fit.rigid_body.rigid_torque(samples) - friction
    return float(np.sqrt(np.mean(error**2) / np.mean(samples.torque**2)))
