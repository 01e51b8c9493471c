"""Noise of the encoders of an arm: how fast a motion they tell, and what torque their noise looks like.

Accelerations are second derivatives of positions, so that this noise grows with the square of the frequency. Links ask
for a torque by it that no drive gave, and whatever follows the motion less than rigid links do takes that away again: a
gear that gives way, above all.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import welch

from fricomp.laws import FloatArray

from .fit import ArmFit
from .rigid.regressor import compute_mass_matrices
from .rows import ArmRows, low_pass

_SEGMENT = 8.0
"""[s] of a spectrum: slow motion leaks into no more than the next frequencies."""

_TOP = 0.75
"""Part of the highest frequency above which a spectrum is noise: motors do not follow there."""

_CLEAR, _BEYOND = 4.0, 2.5
"""Power of a motion in that of the noise, from which it is told, and the cutoff of a low-pass in the frequency up to
which it is, at which that is left as it is."""

_NYQUIST_SHARE = 0.4
"""Highest cutoff of that low-pass, as part of the sample rate."""

_PLACES = 64
"""Postures at which an arm's inertia is averaged."""

_BLURRED = 0.7
"""Torque that the noise of encoders looks like, as part of all that is left of a joint, from which a band is blurred by
it: half of the power."""


def clear_position(position: FloatArray, period: float) -> FloatArray:
    """A motion without what its encoder does not tell from noise [rad] or [m].

    Args:
        position: As recorded [rad] or [m]. Shape (n,).
        period: Between samples [s].
    """
    frequency, power = _measure_spectrum(position, period)
    noise = power[1:] < _CLEAR * _find_floor(frequency, power)
    cutoff = _BEYOND * float(frequency[1 + int(np.argmax(noise))])
    return low_pass(position, cutoff, 1.0 / period) if np.any(noise) and cutoff < _NYQUIST_SHARE / period else position


def is_blurred(rows: ArmRows, fit: ArmFit, noise: FloatArray) -> bool:
    """Whether the noise of encoders is much of what is left of some joint.

    Args:
        rows: Whose band is asked about.
        fit: Of links and rotors.
        noise: What is left of each joint [N·m] or [N]. Shape (n_joints,).
    """
    return bool(np.any(compute_noise_torque(rows, fit) > _BLURRED * noise))


def compute_noise_torque(rows: ArmRows, fit: ArmFit) -> FloatArray:
    """RMS torque that links and rotors ask for by the noise of encoders [N·m] or [N]. Shape (n_joints,)."""
    part = max(rows.parts, key=lambda one: len(one.time))
    density = _find_floor(*_measure_spectrum(part.position, part.period))
    acceleration = np.sqrt(density * rows.measure_noise_gain())
    chosen = np.unique(np.linspace(0, len(rows) - 1, _PLACES).astype(np.intp))
    position = rows.compare(lambda position, _, __: position)[chosen]
    mass = compute_mass_matrices(fit.arm, position, fit.inertia) + np.diag(fit.armature)
    return np.asarray(np.sqrt(np.mean(mass**2, axis=0) @ acceleration**2))


def _measure_spectrum(position: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz], and the power of positions there [rad²/Hz] or [m²/Hz]. Shapes (n,) and (n, ...)."""
    size = min(max(int(_SEGMENT / period), 64), len(position))
    frequency, power = welch(position, 1.0 / period, nperseg=size, detrend="linear", axis=0)
    return np.asarray(frequency), np.asarray(power)


def _find_floor(frequency: FloatArray, power: FloatArray) -> FloatArray:
    """Power of the noise, which is white [rad²/Hz] or [m²/Hz]. Shape (...)."""
    return np.asarray(np.median(power[frequency > _TOP * frequency[-1]], axis=0))
