"""Data checks before any physics: what makes a recording unfit, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Recording, check_recording

__all__ = ["reasons_against"]

_FATAL_WARNINGS = frozenset(
    {
        "no_sliding",
        "degrees",
        "torque_flipped",
        "flipped_torque",
        "motor_side",
        "stuck",
        "rate_change",
        "wrap",
        "gap",
        "gaps",
    }
)
_LONGEST_REST = 25.0  # [s] of standstill without a break


def reasons_against(recordings: Sequence[Recording], joint: str | None) -> list[str]:
    """Why these recordings cannot be diagnosed; empty where they can."""
    reasons = []
    for i, recording in enumerate(recordings):
        prefix = f"recording {i + 1}: " if len(recordings) > 1 else ""
        name = recording.metadata.joint
        if joint is not None and name not in (joint, "joint", ""):
            reasons.append(f"{prefix}it was made on joint {name!r}, not on {joint!r}")
        if recording.metadata.torque_side == "motor":
            reasons.append(f"{prefix}its torque is on the motor side: multiply by gear ratio and efficiency first")
        reasons += [
            prefix + str(finding)
            for finding in check_recording(recording)
            if finding.severity == "error" or finding.code in _FATAL_WARNINGS
        ]
        rest = _longest_rest(recording)
        if rest > max(_LONGEST_REST, 0.4 * recording.duration):
            reasons.append(f"{prefix}the joint stands still for {rest:.0f} s without a break: cut the rest out")
    rates = [recording.sample_period for recording in recordings]
    if rates and max(rates) > 1.5 * min(rates):
        reasons.append(
            f"the recordings have sample rates from {1 / max(rates):.4g} to {1 / min(rates):.4g} Hz: resample them"
        )
    return reasons


def _longest_rest(recording: Recording) -> float:
    """Longest time without motion [s]."""
    position = np.asarray(recording.position)
    tolerance = max(2e-4 * float(np.ptp(position)), 2.0 * (recording.metadata.encoder_resolution or 0.0))
    if tolerance == 0.0:
        return recording.duration
    longest, start = 0.0, 0
    step = max(1, position.size // 2000)
    coarse, time = position[::step], np.asarray(recording.time)[::step]
    for k in range(1, coarse.size):
        if abs(coarse[k] - coarse[start]) > tolerance:
            start = k
        longest = max(longest, float(time[k] - time[start]))
    return longest
