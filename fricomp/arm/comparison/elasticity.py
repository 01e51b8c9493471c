"""Flexible joints whose motors have encoders of their own: how far each gear gives way under its load.

    q_m - q = τ_l / K + c,

with q_m brought to the side of the joint, and τ_l what the gear transmits. Friction and links take the position of the
joint, whatever the motor does, so that an elastic gear changes nothing else in the answer.
"""

from __future__ import annotations

import numpy as np

from fricomp.diagnosis.record.result import Quantity

from ..fit import Z95
from ..identification import ArmIdentification

_BLOCKS = 8

_SEEN = 4.0
"""Standard deviations by which a gear must give way: an encoder that is off by a count shows less."""


def measure_stiffness(found: ArmIdentification, joint: int) -> Quantity | None:
    """Stiffness of a joint's gear, with the interval over blocks of the recording [N·m/rad] or [N/m].

    Args:
        found: The identified arm.
        joint: Number of the joint.

    Returns:
        None where the motor's position was not recorded, or the gear does not visibly give way.
    """
    recording, rows = found.recording.recordings[joint], found.rows
    if recording.motor_position is None:
        return None
    twist = np.asarray(recording.motor_position) - np.asarray(recording.position)
    seen = np.interp(rows.time, recording.time, twist)
    load = found.fit.compute_load(rows)[:, joint]
    block = np.arange(len(seen)) * _BLOCKS // len(seen)
    whole = _fit_compliance(seen, load)
    parts = np.array([_fit_compliance(seen[block != k], load[block != k]) for k in range(_BLOCKS)])
    deviation = float(np.sqrt((_BLOCKS - 1) * np.var(parts)))
    if not whole > _SEEN * deviation:
        return None
    low, high = 1.0 / (whole + Z95 * deviation), 1.0 / (whole - Z95 * deviation)
    metadata = recording.metadata
    return Quantity(1.0 / whole, f"{metadata.torque_unit}/{metadata.position_unit}", (low, high))


def _fit_compliance(twist: np.ndarray, load: np.ndarray) -> float:
    """Slope of the twist over the load [rad/N·m] or [m/N]."""
    centred = load - np.mean(load)
    return float(centred @ (twist - np.mean(twist)) / max(float(centred @ centred), 1e-300))
