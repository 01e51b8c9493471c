"""A small joint in closed loop for the tests of the diagnosis: 20 kHz, PD control at 1 kHz, noisy sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from fricomp.recording import Recording

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class ToyJoint:
    """Truth of the toy joint; the optional effects are zero by default."""

    inertia: float = 0.35
    gravity: float = 6.0
    phase: float = 0.3
    offset: float = 0.05
    forward: tuple[float, float, float, float] = (2.0, 2.9, 0.06, 1.1)
    reverse: tuple[float, float, float, float] = (2.3, 3.3, 0.04, 1.3)
    sigma_0: float = 4e4
    sigma_1: float = 0.0
    load_coulomb: float = 0.0
    cogging: tuple[float, float] = (0.0, 50.0)
    quadratic_drag: float = 0.0
    spring: tuple[float, float, float] = (0.0, 0.0, 0.0)
    torque_noise: float = 0.05
    resolution: float = 2 * np.pi / 2**18
    gains: tuple[float, float] = (900.0, 30.0)
    delay_samples: int = 0
    limit: float = 1e9
    stop: tuple[float, float, float, float] = (0.0, 0.0, 1e9, 2e9)
    """Stiffness [N·m/rad], damping [N·m·s/rad] and edge [rad] of a stop at the upper end, and the free way [rad] to a
    like one at the lower end."""


@numba.njit(cache=True)
def _run(ref: FloatArray, vref: FloatArray, aref: FloatArray, p: FloatArray, substeps: int) -> FloatArray:
    n = ref.size
    out = np.empty((4, n))
    h = 1e-3 / substeps
    x, w, z = ref[0], vref[0], 0.0
    J, grav, ph, off, s0, s1 = p[0], p[1], p[2], p[3], p[12], p[13]
    res = p[18]
    xq_old = ref[0]
    vf = 0.0
    for k in range(n):
        xq = np.round(x / res) * res
        vf += 0.3 * ((xq - xq_old) / 1e-3 - vf)
        xq_old = xq
        tau = p[19] * (ref[k] - xq) + p[20] * (vref[k] - vf) + J * aref[k] + grav * np.sin(xq + ph)
        out[0, k] = xq
        out[1, k] = tau
        tau = min(max(tau, -p[24]), p[24])
        out[2, k] = x
        out[3, k] = w
        for _ in range(substeps):
            b = 4 if w >= 0.0 else 8
            g = p[b] + (p[b + 1] - p[b]) * np.exp(-((w / p[b + 2]) ** 2))
            load = grav * np.sin(x + ph)
            g += p[14] * abs(load)
            zs = g / s0 if w >= 0.0 else -g / s0
            zn = zs + (z - zs) * np.exp(-abs(w) * h * s0 / g)
            fr = s0 * zn + s1 * (zn - z) / h + p[b + 3] * w + p[17] * w * abs(w)
            z = zn
            pull = p[21] * ((x - p[22]) + p[23] * (x - p[22]) ** 3)
            if x > p[27]:
                pull += max(p[25] * (x - p[27]) + p[26] * w, 0.0)
            if x < p[27] - p[28]:
                pull += min(p[25] * (x - p[27] + p[28]) + p[26] * w, 0.0)
            w += h * (tau - load - off - fr - p[15] * np.sin(p[16] * x) - pull) / J
            x += h * w
    return out


def motion(kind: str, duration: float, seed: int = 0) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Reference position, velocity and acceleration at 1 kHz."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration * 1000)) * 1e-3
    if kind == "fourier":
        q, v, a = (np.zeros_like(t) for _ in range(3))
        for k in range(1, 6):
            w = 2 * np.pi * 0.1 * k
            amplitude, angle = rng.uniform(0.3, 0.8) / k, rng.uniform(0, 2 * np.pi)
            q += amplitude * np.sin(w * t + angle)
            v += amplitude * w * np.cos(w * t + angle)
            a -= amplitude * w * w * np.sin(w * t + angle)
        return q, v, a
    if kind == "small":
        ways = np.array([0.06, 0.05, 0.04, 0.03])[:, None]
        rates = 2 * np.pi * np.array([0.3, 0.7, 1.7, 3.1])[:, None]
        at = rates * t + rng.uniform(0, 2 * np.pi, (4, 1))
        parts = (ways * np.sin(at), ways * rates * np.cos(at), -ways * rates**2 * np.sin(at))
        return parts[0].sum(axis=0), parts[1].sum(axis=0), parts[2].sum(axis=0)
    if kind == "slow":
        w = 2 * np.pi * 0.05
        return 0.5 * np.sin(w * t), 0.5 * w * np.cos(w * t), -0.5 * w * w * np.sin(w * t)
    speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.2]
    v = np.zeros_like(t)
    i, sign, position = 0, 1.0, 0.0
    third = t.size * 2 // 3
    while i < third:
        speed = float(rng.choice(speeds))
        length = int(min(2.5, max(0.6, 0.8 / speed)) * 1000)
        sign = -np.sign(position) if abs(position) > 0.7 else -sign
        v[i : i + length] = sign * speed
        position += sign * speed * length * 1e-3
        i += length
        rest = int(rng.choice([0, 200, 1000]))
        i += rest
    v[third:] = 0.0
    for f in (0.13, 0.31, 0.72, 1.1):
        v[third:] += 0.35 * np.sin(2 * np.pi * f * t[third:] + rng.uniform(0, 6))
    kernel = np.hanning(101)
    v = np.convolve(v, kernel / kernel.sum(), "same")
    v[:200] *= np.linspace(0, 1, 200)
    return np.cumsum(v) * 1e-3, v, np.gradient(v, 1e-3)


def recording(
    joint: ToyJoint, kind: str = "rich", duration: float = 60.0, seed: int = 0, *, every: int = 1
) -> Recording:
    """The recording of `joint` as the library's own value, of so many samples one."""
    columns = record(joint, kind, duration, seed)
    time, position, torque = (columns[name][::every] for name in ("time", "position", "torque"))
    return Recording(time, position, torque)


def record(joint: ToyJoint, kind: str = "rich", duration: float = 60.0, seed: int = 0) -> dict[str, FloatArray]:
    """Simulate `joint` in closed loop; columns of the recording and the true trajectory."""
    rng = np.random.default_rng(seed + 1000)
    ref, vref, aref = motion(kind, duration, seed)
    p = np.array(
        [
            joint.inertia,
            joint.gravity,
            joint.phase,
            joint.offset,
            *joint.forward,
            *joint.reverse,
            joint.sigma_0,
            joint.sigma_1,
            joint.load_coulomb,
            *joint.cogging,
            joint.quadratic_drag,
            joint.resolution,
            *joint.gains,
            *joint.spring,
            joint.limit,
            *joint.stop,
        ]
    )
    out = _run(ref, vref, aref, p, 20)
    torque = out[1] + joint.torque_noise * rng.standard_normal(ref.size)
    if joint.delay_samples:
        torque = np.concatenate([np.full(joint.delay_samples, torque[0]), torque[: -joint.delay_samples]])
    return {
        "time": np.arange(ref.size) * 1e-3,
        "position": out[0],
        "torque": torque,
        "position_reference": ref,
        "true_position": out[2],
        "true_velocity": out[3],
    }
