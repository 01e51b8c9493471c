"""One joint's inertia, gravity, offset and friction from a recorded motion, by filtered regression.

Torque and regressors pass through the same low-pass filter and are decimated together [gautier1997filtering], so the
filter cancels; position is differentiated after a zero-phase low-pass. Friction is then refined on what the rigid
body leaves of the torque. Around a reversal the low-pass mixes the friction of both directions, which a curve over the
filtered velocity cannot say: what it does to the friction found so far is taken off, a few times over.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .identification import IdentificationOptions, IdentificationResult, identify
from .identification.form import separable_law
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


_REFINEMENTS = 3
"""Times that friction and rigid body are refined; a third one moved parameters by less than a standard deviation."""


@dataclass(frozen=True)
class RecordedVelocity:
    """The velocity before the low-pass that samples have gone through.

    Attributes:
        parts: Velocity of each part between gaps, at the recording's own rate [rad/s] or [m/s].
        low_pass: Second-order sections of the filter, which each part has gone through on its own.
        index: Positions of the samples in the parts, one after the other. Shape (n,).
    """

    parts: tuple[FloatArray, ...]
    low_pass: FloatArray
    index: np.ndarray[tuple[int], np.dtype[np.intp]]

    def filtered_torque(self, model: FrictionModel) -> FloatArray:
        """Friction of `model` as the low-pass shows it at the samples [N·m] or [N]. Shape (n,)."""
        torques = [np.asarray(model.torque(velocity), dtype=np.float64) for velocity in self.parts]
        return np.concatenate([sosfiltfilt(self.low_pass, torque) for torque in torques])[self.index]


@dataclass(frozen=True)
class JointSamples:
    """Filtered, decimated samples.

    Attributes:
        position: [rad] or [m]. Shape (n,).
        velocity: [rad/s] or [m/s]. Shape (n,).
        acceleration: [rad/s²] or [m/s²]. Shape (n,).
        direction: Low-passed sign of the velocity; between -1 and 1 near a reversal. Shape (n,).
        torque: [N·m], [N] or the recording's unit. Shape (n,).
        recorded: The velocity that they were filtered from.
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    torque: FloatArray
    recorded: RecordedVelocity

    def between(self, begin: float, end: float) -> JointSamples:
        """The part from `begin` to `end`, as fractions of the whole."""
        n = len(self.torque)
        part = slice(round(begin * n), round(end * n))
        columns = {name: values[part] for name, values in vars(self).items() if name != "recorded"}
        return JointSamples(**columns, recorded=replace(self.recorded, index=self.recorded.index[part]))


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
        rigid_body: Inertia, gravity and offset, with the symmetric friction fitted beside them. The offset is 0 where
            the law has friction of its own in each direction: sliding cannot tell one from the other.
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
    low_pass = butter(4, min(settings.torque_cutoff, 0.4 * rate), fs=rate, output="sos")
    filtered, velocities, kept = zip(*(_filter(even, recording, low_pass, settings) for even in times), strict=True)
    starts = np.concatenate([[0], np.cumsum([len(even) for even in times])[:-1]])
    index = np.concatenate([start + part for start, part in zip(starts, kept, strict=True)])
    position, velocity, acceleration, direction, torque = np.concatenate(filtered, axis=1)
    recorded = RecordedVelocity(velocities, low_pass, index)
    return JointSamples(position, velocity, acceleration, direction, torque, recorded)


def split_for(recording: Recording, settings: RegressionSettings = _DEFAULTS) -> MotionParts:
    """The parts of a recording that are filtered; gaps below half a period of the position's cutoff are bridged."""
    return split_motion(recording, shortest_gap=0.5 / settings.position_cutoff, margin=settings.margin)


def _filter(
    even: FloatArray, recording: Recording, low_pass: FloatArray, settings: RegressionSettings
) -> tuple[FloatArray, FloatArray, np.ndarray[tuple[int], np.dtype[np.intp]]]:
    """One part without gaps: the first columns of `JointSamples`, the velocity before its filter, and which are kept.

    Args:
        even: Times at the recording's rate [s]. Shape (n,).
        recording: What is sampled at them.
        low_pass: Second-order sections of the filter.
        settings: Cutoffs and margin.
    """
    rate = 1.0 / recording.sample_period
    position = np.interp(even, recording.time, recording.position)
    torque = np.interp(even, recording.time, recording.torque)
    smooth = sosfiltfilt(butter(4, min(settings.position_cutoff, 0.4 * rate), fs=rate, output="sos"), position)
    velocity = np.gradient(smooth, 1.0 / rate)
    columns = np.stack([smooth, velocity, np.gradient(velocity, 1.0 / rate), np.sign(velocity), torque])
    factor = max(1, int(rate / (5.0 * settings.torque_cutoff)))
    skip = max(1, int(settings.margin * rate / factor))
    kept = np.arange(0, len(even), factor)[skip:-skip]
    return sosfiltfilt(low_pass, columns, axis=1)[:, kept], velocity, kept


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

    Samples near a reversal, where filters mix both directions, are left out of the friction curve. A constant torque
    and friction that differs between the directions look alike while the joint slides: a law with a curve for each
    direction takes the whole of it, and says so, unless friction would have to drive the joint in one of them.

    Raises:
        IdentificationError: The motion does not tell the parts apart.
    """
    symmetric = fit_rigid_body(samples, gravity=settings.gravity)
    shares_offset = separable_law(law).bidirectional and abs(symmetric.offset) < symmetric.coulomb_torque
    rigid = replace(symmetric, offset=0.0) if shares_offset else symmetric
    top = float(np.max(np.abs(samples.velocity)))
    sliding = (np.abs(samples.direction) > 0.98) & (np.abs(samples.velocity) > settings.slowest * top)
    velocity, mixed = samples.velocity[sliding], np.zeros_like(samples.torque)
    chosen = options or IdentificationOptions()
    for _ in range(_REFINEMENTS):
        friction = (samples.torque - rigid.rigid_torque(samples) - mixed)[sliding]
        model = identify(velocity, friction, None, "least_squares", "absolute", law=law, options=chosen).model
        filtered = samples.recorded.filtered_torque(model)
        mixed = filtered - np.asarray(model.torque(samples.velocity))
        rigid = _refit_body(rigid, samples, filtered, settings.gravity, has_offset=not shares_offset)
    friction = (samples.torque - rigid.rigid_torque(samples) - mixed)[sliding]
    result = identify(velocity, friction, noise="absolute", law=law, options=chosen)
    if shares_offset:
        result = _with_offset_note(result, symmetric.offset)
    return MotionIdentification(rigid, result, np.stack([velocity, friction], axis=1))


def _refit_body(
    rigid: RigidBodyFit, samples: JointSamples, friction: FloatArray, gravity: bool, *, has_offset: bool
) -> RigidBodyFit:
    """`rigid` with inertia, gravity and offset fitted to what `friction` leaves of the torque."""
    columns = [samples.acceleration]
    columns += [np.cos(samples.position), np.sin(samples.position)] if gravity else []
    columns += [np.ones_like(samples.torque)] if has_offset else []
    solution = np.linalg.lstsq(np.stack(columns, axis=1), samples.torque - friction, rcond=None)[0].tolist()
    return replace(
        rigid,
        inertia=solution[0],
        gravity=(solution[1], solution[2]) if gravity else rigid.gravity,
        offset=solution[-1] if has_offset else rigid.offset,
    )


def _with_offset_note(result: IdentificationResult, offset: float) -> IdentificationResult:
    """With a sentence on where the torque offset went, for people and in the model file."""
    unit = result.model.torque_unit
    said = (
        "a constant torque offset cannot be told from friction that differs between the directions and counts as such; "
        f"with the same friction in both it would be {offset:.4g} {unit}"
    )
    provenance = result.model.provenance
    provenance = replace(provenance, notes={**provenance.notes, "torque_offset": f"0 assumed: {said}"})
    model = replace(result.model, provenance=provenance)
    return replace(result, model=model, message=f"{result.message}; {said}")


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
