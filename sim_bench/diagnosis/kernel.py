"""The compiled simulator: one joint with bristle friction, held to a recording by an observer.

    J w' = tau - F_v w - sigma_0 z - sigma_1 z' + u,   u = K (q - x) + D (v - w)
    z' = w - sigma_0 |w| z / g(w),   g(w) = F_c + (F_s - F_c) exp(-|w / v_s|^delta) + extra level

x, w, z are the model's own position, velocity and bristle deflection; q, v the recorded ones; u is the torque the
model lacks, seen through a second-order low pass. A share of the bristle (`sharpness`) yields abruptly at its level
instead of gradually, as the elements of Maxwell-slip models do [albender2005gms]. Both are advanced exactly over each
substep [dahl1968], [canudas1995lugre], so any stiffness is stable for them. This is the only module that imports numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from fricomp.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

try:
    import numba
except ImportError as error:  # pragma: no cover - depends on the installation
    raise MissingExtraError("numba", "diagnose") from error

__all__ = [
    "FRICTION_SLOTS",
    "compiled",
    "dwell",
    "observe",
]

_F = TypeVar("_F", bound="Callable[..., Any]")

# Order of the plant's numbers in the array that the kernel takes.
FRICTION_SLOTS = (
    "inertia",
    "forward.coulomb_torque",
    "forward.static_torque",
    "forward.stribeck_velocity",
    "forward.viscous_coefficient",
    "forward.stribeck_exponent",
    "reverse.coulomb_torque",
    "reverse.static_torque",
    "reverse.stribeck_velocity",
    "reverse.viscous_coefficient",
    "reverse.stribeck_exponent",
    "sigma_0",
    "sigma_1",
    "lag",
    "sharpness",
    "spread",
)


def compiled(function: _F) -> _F:
    """Compile with numba, cached on disk, without holding the interpreter lock: two threads use two cores."""
    return cast(_F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))


@compiled
def observe(
    position: np.ndarray,
    velocity: np.ndarray,
    torque: np.ndarray,
    level: np.ndarray,
    plant: np.ndarray,
    observer: np.ndarray,
    out: np.ndarray,
) -> None:
    """Run the observed joint along one recording.

    Args:
        position: Recorded q [rad]. Shape (n,).
        velocity: Estimated v [rad/s]. Shape (n,).
        torque: Applied torque less gravity and offset [N·m]. Shape (n,).
        level: Torque added to the dry friction level [N·m]. Shape (n,).
        plant: Numbers in the order of `FRICTION_SLOTS`.
        observer: dt [s], substeps, K [N·m/rad], D [N·m·s/rad], rest speed [rad/s], leak [1/s].
        out: Filled with u [N·m], x [rad], w [rad/s], bristle torque [N·m]. Shape (4, n). Position and velocity stand
            at the sample, torques are means until the next one.
    """
    inertia, sigma_0, sigma_1, lag = plant[0], plant[11], plant[12], plant[13]
    sharpness, spread = plant[14], plant[15]
    dt, substeps = observer[0], int(observer[1])
    stiffness, damping, rest_speed, leak = observer[2], observer[3], observer[4], observer[5]
    x, w, z = position[0], velocity[0], 0.0
    first, second, third = 0.0, 0.0, 0.0
    w_felt = w
    n = position.shape[0]
    h = dt / substeps
    keep = np.exp(-h / lag) if lag > 0.0 else 0.0
    for k in range(n):
        k1 = min(k + 1, n - 1)
        sum_u, sum_b = 0.0, 0.0
        out[1, k] = x
        out[2, k] = w
        resting = abs(velocity[k]) < rest_speed
        for s in range(substeps):
            f = (s + 0.5) / substeps
            q = position[k] + (position[k1] - position[k]) * f
            v = velocity[k] + (velocity[k1] - velocity[k]) * f
            tau = torque[k] + (torque[k1] - torque[k]) * f
            extra = level[k] + (level[k1] - level[k]) * f
            u = stiffness * (q - x) + damping * (v - w)
            w_felt = w + (w_felt - w) * keep
            felt = abs(w_felt)
            base = 1 if w >= 0.0 else 6
            ratio = felt / plant[base + 2]
            delta = plant[base + 4]
            power = ratio * ratio if delta == 2.0 else ratio**delta
            fall = np.exp(-power) if power < 30.0 else 0.0
            g = plant[base] + (plant[base + 1] - plant[base]) * fall + extra
            if g < 1e-9:
                g = 1e-9
            steady = g / sigma_0 if w >= 0.0 else -g / sigma_0
            decay = abs(w) * h * sigma_0 / g
            z_next = steady + (z - steady) * np.exp(-decay) if decay < 30.0 else steady
            mean_before = z + sharpness * ((first + second + third) / 3.0 - z)
            first = min(max(first + spread * w * h, -g / sigma_0), g / sigma_0)
            second = min(max(second + w * h, -g / sigma_0), g / sigma_0)
            third = min(max(third + w * h / spread, -g / sigma_0), g / sigma_0)
            z = z_next
            mean = z + sharpness * ((first + second + third) / 3.0 - z)
            bristle = sigma_0 * mean + sigma_1 * (mean - mean_before) / h
            viscous = plant[base + 3] * w_felt
            before = w
            w += h * (tau - viscous - bristle + u) / inertia
            x += 0.5 * h * (before + w)
            if resting and abs(w) < rest_speed:
                x += h * leak * (q - x)
            sum_u += u
            sum_b += bristle
        out[0, k] = sum_u / substeps
        out[3, k] = sum_b / substeps


@compiled
def dwell(velocity: np.ndarray, settings: np.ndarray) -> np.ndarray:
    """Share of its final rise that static friction has gained by resting, lost again over a short travel.

    Args:
        velocity: Velocity [rad/s]. Shape (n,).
        settings: dt [s], time constant [s], travel over which it is lost [rad], rest speed [rad/s].
    """
    out = np.empty_like(velocity)
    grown = 0.0
    gain = 1.0 - np.exp(-settings[0] / max(settings[1], 1e-6))
    for k in range(velocity.shape[0]):
        speed = abs(velocity[k])
        if speed < settings[3]:
            grown += gain * (1.0 - grown)
        else:
            grown *= np.exp(-speed * settings[0] / max(settings[2], 1e-9))
        out[k] = grown
    return out
