"""What can be injected: the torque of each effect along a measured motion, and what a refit of the base leaves of it.

Written for this purpose only; it shares no code with the diagnosis or with the friction laws.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.root_mean_square import compute_rms

from ..kit.rigid_joint import N_BODY, Samples, build_joint_columns

_SMOOTHING = 0.05  # [s] of the Savitzky-Golay window that position is differentiated with, at least 7 samples
_WINDOW = 0.042  # [s] over which residuals are averaged, as on simulated cases
_SLOWEST = 0.02  # of the RMS speed: slower samples count as resting, where friction has no known direction


class InjectedTorque(NamedTuple):
    """An effect along one motion.

    Attributes:
        torque: What it adds to the recorded torque. Shape (n_samples,).
        parameters: Value and unit by the name that the catalogue gives the parameter.
    """

    torque: Samples
    parameters: dict[str, tuple[float, str]]


@dataclass(frozen=True)
class MeasuredMotion:
    """What one recording says about its motion, with the base refitted; arrays of shape (n_samples,).

    Attributes:
        time: [s]
        position: As recorded [rad or m].
        velocity: Of the smoothed position [rad/s or m/s].
        acceleration: [rad/s² or m/s²]
        torque: As recorded.
        load: Inertia and gravity of the refitted base [as torque].
        base: Columns of the base in windows, orthonormal. Shape (n_windows, n_columns).
        moving: Which windows count. Shape (n_windows,).
        left: What the refit leaves of the recorded torque in windows. Shape (n_moving,).
        span: Range of the positions of all recordings of the joint [rad or m].
    """

    time: Samples
    position: Samples
    velocity: Samples
    acceleration: Samples
    torque: Samples
    load: Samples
    base: Samples
    moving: NDArray[np.bool_]
    left: Samples
    span: float

    @property
    def direction(self) -> Samples:
        """Sign of the velocity, falling smoothly to zero at rest. Shape (n_samples,)."""
        return np.asarray(np.tanh(self.velocity / (_SLOWEST * compute_rms(self.velocity))))

    def left_of(self, torque: Samples) -> Samples:
        """What a refit of the base leaves of a torque, in windows. Shape (n_moving,)."""
        rows = _windows(torque, self.time)[self.moving]
        return np.asarray(rows - self.base @ (self.base.T @ rows))


def _windows(values: Samples, time: Samples) -> Samples:
    """Means over windows that do not overlap; the columns of a two-dimensional array each on its own."""
    width = max(1, round(_WINDOW / float(np.median(np.diff(time)))))
    whole = values[: len(values) // width * width]
    return np.asarray(whole.reshape(-1, width, *values.shape[1:]).mean(axis=1))


def measure_motion(time: Samples, position: Samples, torque: Samples, span: float) -> MeasuredMotion:
    """Differentiate the position and refit a rigid joint with a Stribeck curve for each direction."""
    from scipy.signal import savgol_filter

    dt = float(np.median(np.diff(time)))
    length = max(7, 2 * round(0.5 * _SMOOTHING / dt) + 1)
    q, v, a = (savgol_filter(position, length, 3, deriv=k, delta=dt) for k in range(3))
    moving = np.abs(_windows(v, time)) > _SLOWEST * compute_rms(v)
    wanted = _windows(torque, time)[moving]

    def fit(width: float) -> tuple[Samples, Samples, Samples]:
        columns = build_joint_columns(q, v, a, width)
        rows = _windows(columns, time)[moving]
        solution = np.linalg.lstsq(rows, wanted, rcond=1e-10)[0]
        return rows, columns[:, :N_BODY] @ solution[:N_BODY], wanted - rows @ solution

    widths = (np.geomspace(0.03, 1.0, 10) * compute_rms(v)).tolist()
    rows, load, left = min(map(fit, widths), key=lambda fitted: compute_rms(fitted[2]))
    scale = np.linalg.norm(rows, axis=0)
    basis, values, _ = np.linalg.svd(rows[:, scale > 0.0] / scale[scale > 0.0], full_matrices=False)
    kept = basis[:, values > 1e-8 * values[0]]
    return MeasuredMotion(time, position, v, a, torque, load, kept, moving, left, span)


def _cogging(motion: MeasuredMotion, amplitude: float, rng: np.random.Generator) -> InjectedTorque:
    """A sine over the position that the recording passes through many times."""
    order, phase = 2.0 * np.pi * rng.uniform(6.0, 14.0) / motion.span, rng.uniform(0.0, 2.0 * np.pi)
    sine, cosine = amplitude * np.cos(phase), amplitude * np.sin(phase)
    wave = sine * np.sin(order * motion.position) + cosine * np.cos(order * motion.position)
    return InjectedTorque(
        wave, {"sine": (sine, "torque"), "cosine": (cosine, "torque"), "order": (order, "1/position")}
    )


def _position_coulomb(motion: MeasuredMotion, amplitude: float, rng: np.random.Generator) -> InjectedTorque:
    ripple = _cogging(motion, amplitude, rng)
    return ripple._replace(torque=ripple.torque * motion.direction)


def _quadratic_drag(motion: MeasuredMotion, amplitude: float, rng: np.random.Generator) -> InjectedTorque:
    drag = amplitude * motion.velocity * np.abs(motion.velocity)
    return InjectedTorque(drag, {"coefficient": (amplitude, "torque·s²/position²")})


def _load_coulomb(motion: MeasuredMotion, amplitude: float, rng: np.random.Generator) -> InjectedTorque:
    friction = amplitude * np.abs(motion.load) * motion.direction
    return InjectedTorque(friction, {"coefficient": (amplitude, "1")})


def _torque_delay(motion: MeasuredMotion, amplitude: float, rng: np.random.Generator) -> InjectedTorque:
    late = np.interp(motion.time - amplitude, motion.time, motion.torque)
    return InjectedTorque(late - motion.torque, {"delay": (amplitude, "s")})


@dataclass(frozen=True)
class InjectedEffect:
    """An effect that can be injected.

    Attributes:
        build: Its torque at an amplitude; draws the same numbers at every amplitude.
        kind: As in the catalogue.
        unit: Amplitude to begin the search with.
        limit: Largest amplitude.
    """

    build: Callable[[MeasuredMotion, float, np.random.Generator], InjectedTorque]
    kind: Literal["physics", "measurement"] = "physics"
    unit: float = 1.0
    limit: float = np.inf


INJECTED = {
    "cogging": InjectedEffect(_cogging),
    "position_coulomb": InjectedEffect(_position_coulomb),
    "quadratic_drag": InjectedEffect(_quadratic_drag),
    "load_coulomb": InjectedEffect(_load_coulomb, limit=2.0),
    "torque_delay": InjectedEffect(_torque_delay, "measurement", unit=1e-3, limit=0.03),
}
