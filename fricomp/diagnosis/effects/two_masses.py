"""What a load draws through a flexible or loose transmission, compared with a rigid one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs

from fricomp.root_mean_square import compute_rms

from ..inputs.track import FloatArray
from ..joint.kernel import compile_kernel
from .context import Context
from .settings import EFFECT

ComplexArray = NDArray[np.complex128]

__all__ = [
    "CarriedLoad",
    "Coupling",
    "Transmission",
    "compute_carried",
    "compute_twist",
    "compute_uneven_running",
]


@dataclass(frozen=True)
class Transmission:
    """A spring with a gap between the motor, where position is measured, and the load.

    Attributes:
        inertia: Inertia of the load [kg·m²].
        stiffness: K [N·m/rad].
        damping_ratio: Damping ratio of the load on its spring.
        gap: Total free travel [rad].
        hardening: Relative rise of the stiffness at the largest static load.
    """

    inertia: float
    stiffness: float
    damping_ratio: float
    gap: float = 0.0
    hardening: float = 0.0

    def build_coupling(self, context: Context) -> Coupling:
        """The numbers of its equation of motion, under the loads of one recording."""
        largest = max(float(np.hypot(*context.plant.gravity)) if context.rotary else 0.0, context.scale)
        damping = 2.0 * self.damping_ratio * float(np.sqrt(self.stiffness / self.inertia)) * self.inertia
        return Coupling(self.inertia, self.stiffness, damping, 0.5 * self.gap, self.hardening / largest**2)


class Coupling(NamedTuple):
    """How a load hangs on the motor side: J_l theta'' = K d (1 + h (K d)²) + c s' - gravity(theta).

    Attributes:
        inertia: J_l [kg·m²].
        stiffness: K [N·m/rad].
        damping: c [N·m·s/rad].
        half_gap: Way to either side of the middle in which the load is free [rad].
        hardening: h [1/(N·m)²].
    """

    inertia: float
    stiffness: float
    damping: float
    half_gap: float = 0.0
    hardening: float = 0.0

    def join(self, other: Coupling) -> Coupling:
        """One load behind both: the softer spring, and both gaps."""
        softer = min(self, other, key=lambda one: one.stiffness)
        return softer._replace(half_gap=self.half_gap + other.half_gap)

    def compute_rate(self, inertia: float) -> float:
        """Rate of the load on its spring with a motor side of `inertia` [kg·m²] at the other end [1/s]."""
        return float(np.sqrt(self.stiffness * (1.0 / self.inertia + 1.0 / inertia)))

    def compute_rest(self, gravity: float) -> float:
        """Load less motor position where the spring holds this torque [rad]."""
        return -gravity / self.stiffness - (self.half_gap if gravity >= 0.0 else -self.half_gap)

    def pull(self, lead: float, rate: float) -> tuple[float, float]:
        """Torque of the spring on the load [N·m], and the damping [N·m·s/rad] beside it, none of both in the gap.

        Args:
            lead: Load less motor position [rad].
            rate: Its rate of change [rad/s].
        """
        stretch = -lead - min(max(-lead, -self.half_gap), self.half_gap)
        elastic = self.stiffness * stretch
        elastic *= 1.0 + self.hardening * elastic * elastic
        # Teeth push and never pull, however fast they part.
        free = self.half_gap > 0.0 and (elastic - self.damping * rate) * stretch <= 0.0
        return (0.0, 0.0) if free else (elastic, self.damping)


class CarriedLoad(NamedTuple):
    """What hangs on the far side of a transmission, sample by sample. Shapes (n,).

    Attributes:
        inertia: J_l [kg·m²].
        gravity: All torque on the load at the motor's position that is not its own acceleration's [N·m].
        gradient: The derivative of that by the position [N·m/rad].
    """

    inertia: FloatArray
    gravity: FloatArray
    gradient: FloatArray


@compile_kernel
def simulate_twist(
    position: np.ndarray, inertia: np.ndarray, gravity: np.ndarray, gradient: np.ndarray, settings: np.ndarray
) -> np.ndarray:
    """Motor less load position when the motor side moves as recorded [rad]. Shape (n,).

        J_l theta'' = K d (1 + h (K d)²) + c s' - gravity(theta),  s = q - theta,  d = s outside of the gap

    Args:
        position: Motor-side position q [rad]. Shape (n,).
        inertia: Of the load [kg·m²]. Shape (n,).
        gravity: Gravity torque on a load at q [N·m]. Shape (n,).
        gradient: Its derivative by the position [N·m/rad]. Shape (n,).
        settings: dt [s], substeps, K, c, half gap [rad], h [1/(N·m)²].
    """
    out = np.empty_like(position)
    substeps = int(settings[1])
    h = settings[0] / substeps
    stiffness, damping, half, cubic = settings[2], settings[3], settings[4], settings[5]
    n = position.shape[0]
    theta = position[0] - gravity[0] / stiffness - (half if gravity[0] >= 0.0 else -half)
    # The load begins with the mean velocity of the first samples, which the encoder's steps do not reach.
    w = (position[min(8, n - 1)] - position[0]) / (min(8, n - 1) * settings[0])
    for k in range(n):
        push = h / inertia[k]
        speed = (position[min(k + 1, n - 1)] - position[k]) / settings[0]
        out[k] = position[k] - theta
        for i in range(substeps):
            # Where the load is known, and half a step before and after that its rate: any other place is a delay.
            s = position[k] + speed * h * i - theta
            # Every sum waits for the last one, so a spring without a gap does without those for the gap.
            stretch = s if half == 0.0 else s - min(max(s, -half), half)
            torque = 0.0
            if stretch != 0.0 or half == 0.0:
                elastic = stiffness * stretch
                if cubic > 0.0:
                    elastic *= 1.0 + cubic * elastic * elastic
                torque = elastic + damping * (speed - w)
                if half > 0.0 and torque * stretch < 0.0:
                    torque = 0.0
            w += push * (torque + (gradient[k] * s - gravity[k]))
            theta += h * w
    return out


def compute_carried(context: Context, transmission: Transmission) -> FloatArray:
    """Compute the torque on the motor side beyond that of a rigid transmission [N·m]. Shape (n,).

    The load lags by the twist s, so the motor carries gravity(q - s) - gravity(q) - J_l s'' more.
    """
    t, q = transmission, context.position
    gravity, gradient = _compute_gravity(context)
    load = CarriedLoad(np.full(q.size, t.inertia), gravity, gradient)
    s = compute_twist(q, context.dt, load, t.build_coupling(context))
    # A local cubic goes through four samples, so its curvature needs five.
    window = max(5, 2 * round(EFFECT.twist_window / context.dt / 2) + 1)
    curvature = np.convolve(s, _compute_curvature_weights(window, context.dt), mode="same")
    curvature[: window // 2] = curvature[-(window // 2) :] = 0.0
    return _add_ringing(context, t, np.asarray(-gradient * s - t.inertia * curvature))


def _add_ringing(context: Context, t: Transmission, carried: FloatArray) -> FloatArray:
    """The same with the load's own swing from its state at the first sample, which no encoder says. Shape (n,).

    The recorded torque tells it, where the joint slides. The load may be off its rest by what the recording's usual
    acceleration would twist its spring.
    """
    rate = float(np.sqrt(t.stiffness / t.inertia))
    ratio = min(t.damping_ratio, 1.0)
    n = min(carried.size, round(EFFECT.ringing / (ratio * rate * context.dt)))
    usual = t.inertia * compute_rms(context.acceleration)
    swing = usual * np.exp(rate * (-ratio + 1j * np.sqrt(1.0 - ratio**2)) * context.time[:n])
    slides = np.abs(context.velocity) > context.stribeck_velocity
    left = context.recorded - context.torque - carried
    columns, shown = np.stack([swing.real, swing.imag], axis=1)[slides[:n]], left[:n][slides[:n]]
    if shown.size == 0:
        return carried
    # Ridge regression: each coefficient is a standard normal number beforehand, beside what all sliding rows leave,
    # which is about the same for a period. A few samples late in the swing then tell next to nothing of its beginning.
    alike = max(2.0 * np.pi / (rate * context.dt), 1.0)
    noise = alike * max(float(np.mean(left[slides] ** 2)), np.finfo(np.float64).tiny)
    along = np.linalg.solve(columns.T @ columns + noise * np.eye(2), columns.T @ shown)
    carried[:n] += along[0] * swing.real + along[1] * swing.imag
    return carried


def compute_twist(position: FloatArray, dt: float, load: CarriedLoad, coupling: Coupling) -> FloatArray:
    """Motor less load position when the motor side moves as recorded [rad]. Shape (n,).

    Args:
        position: Of the motor side [rad]. Shape (n,).
        dt: Time between samples [s].
        load: What hangs on it.
        coupling: How; its inertia is that of `load`.
    """
    frequency = np.sqrt(coupling.stiffness / float(np.min(load.inertia)))
    substeps = int(np.clip(np.ceil(frequency * dt / EFFECT.twist_substep), 1, EFFECT.most_substeps))
    twist: FloatArray = simulate_twist(position, *load, np.array([dt, substeps, *coupling[1:]]))
    return twist


@cache
def _compute_curvature_weights(window: int, dt: float) -> FloatArray:
    """Weights of a local cubic's second derivative over `window` samples [1/s²]; they take a fit of their own."""
    weights: FloatArray = savgol_coeffs(window, 3, deriv=2, delta=dt)
    return weights


def _compute_gravity(context: Context) -> tuple[FloatArray, FloatArray]:
    """Gravity torque [N·m] and its derivative by the position [N·m/rad]. Shapes (n,)."""
    if not context.rotary:
        return np.zeros_like(context.position), np.zeros_like(context.position)
    cosine, sine = context.waves
    a, b = context.plant.gravity
    return a * cosine + b * sine, b * cosine - a * sine


def compute_uneven_running(context: Context, order: FloatArray | float, load_share: float) -> ComplexArray:
    """Compute the torque for each radian by which the load leads as exp(i n q), divided by that wave [N·m/rad]. Shape
    (n,).

    Lagrange's equation of a load at q + e(q): e' (gravity + 2 J_l a) + J_l e'' v² + gravity' e.
    """
    inertia = context.plant.inertia * load_share
    v, a = context.velocity, context.acceleration
    gravity, gradient = _compute_gravity(context)
    torque = 1j * order * (gravity + 2.0 * inertia * a) - order**2 * inertia * v**2 + gradient
    return np.asarray(torque, dtype=np.complex128)
