"""A simulated joint under a PD loop, logged as a drive would: the good log that flaws are put into."""

from functools import lru_cache

import numpy as np

from fricomp.recording import Recording, RecordingMetadata

INERTIA, COULOMB, VISCOUS = 0.03, 0.4, 0.15
"""Of the joint [kg·m², N·m, N·m·s/rad]."""
_SWINGS = ((0.6, 0.27), (0.3, 0.71), (0.12, 1.3))
"""Amplitudes [rad] and frequencies [Hz] of the reference."""
_Swings = tuple[tuple[float, float], ...]


@lru_cache(maxsize=16)
def _simulate(
    seconds: float, rate: float, seed: int, swings: _Swings
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Columns time, position, velocity and torque; the torque is that of the loop, held for a sample."""
    rng = np.random.default_rng(seed)
    steps, period = 5, 1.0 / rate
    t = np.arange(int(seconds * rate)) * period
    phases = rng.uniform(0.0, 2.0 * np.pi, len(swings))
    reference = np.sum([a * np.sin(2.0 * np.pi * f * t + p) for (a, f), p in zip(swings, phases, strict=True)], axis=0)
    speed = np.gradient(reference, period)
    q, v, h = float(reference[0]), 0.0, period / steps
    rows = np.empty((t.size, 4))
    for k, (r, s) in enumerate(zip(reference.tolist(), speed.tolist(), strict=True)):
        torque = 30.0 * (r - q) + 1.0 * (s - v)
        rows[k] = t[k], q, v, torque
        for _ in range(steps):
            free = v + h / INERTIA * (torque - VISCOUS * v)
            v = float(np.copysign(max(abs(free) - h / INERTIA * COULOMB, 0.0), free))
            q += h * v
    return rows


def joint_log(seconds: float, rate: float, seed: int = 0, swings: _Swings = _SWINGS, **metadata: object) -> Recording:
    """A recording of the joint with an 18-bit encoder and a little noise in its torque."""
    t, q, v, torque = _simulate(seconds, rate, seed, swings).T
    rng = np.random.default_rng(seed + 1)
    count = 2.0 * np.pi / 2**18
    return Recording(
        t,
        np.round(q / count) * count,
        torque + rng.normal(0.0, 0.004, t.size),
        velocity=v + rng.normal(0.0, 0.002, t.size),
        metadata=RecordingMetadata(joint="elbow", **metadata),  # type: ignore[arg-type]
    )
