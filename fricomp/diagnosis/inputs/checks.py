"""Data checks before any physics: what makes a recording unfit, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.recording import Finding, Recording, check_recording

from .track import FloatArray

__all__ = ["inertia_against", "kind_against", "reasons_against", "remarks_on"]

_FATAL_WARNINGS = frozenset({"no_sliding", "stuck", "gap"})
_OTHER_JOINT = 15.0  # times a simulation's inertia that no payload explains; the base goes up to 20
_LONGEST_REST = 25.0  # [s] of standstill without a break
_GAP_PERIODS = 5.0  # as in the check of the recording
_LONGEST_BRIDGE = 0.03  # [s] shorter than a row of the residual
_MOST_BRIDGED = 0.01  # of the time


def reasons_against(recordings: Sequence[Recording], joint: str | None) -> list[str]:
    """Why these recordings cannot be diagnosed; empty where they can."""
    reasons = []
    for i, recording in enumerate(recordings):
        prefix = f"recording {i + 1}: " if len(recordings) > 1 else ""
        name = recording.metadata.joint
        if joint is not None and name not in (joint, "joint", ""):
            reasons.append(f"{prefix}it was made on joint {name!r}, not on {joint!r}")
        reasons += [
            prefix + str(finding)
            for finding in check_recording(recording)
            if _fatal(finding) and not (finding.code == "gap" and _bridged(recording) is not None)
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


def _fatal(finding: Finding) -> bool:
    """Errors, and what would only give physics names that a unit makes; a suspected speed alone may be right."""
    suspected = finding.code == "degrees_suspected" and finding.column == "position"
    return finding.severity == "error" or finding.code in _FATAL_WARNINGS or suspected


def inertia_against(found: float, given: float) -> list[str]:
    """Why an inertia that the motion asks for cannot be that of the simulation; empty where it can.

    Args:
        found: Inertia that the recording asks for [kg·m²] or [kg].
        given: Inertia in the simulation, in the same unit.
    """
    factor = max(found / given, given / found)
    if factor < _OTHER_JOINT:
        return []
    larger = "its torque in N·m (mN·m: factor 1000), its position in radians and not in turns"
    smaller = "its position in radians (degrees: factor 57.3), its torque on the joint side"
    which, likely = ("larger", larger) if found > given else ("smaller", smaller)
    return [
        f"the motion asks for an inertia {factor:.0f} or more times {which} than that of the simulation: check "
        f"that the recording is of this joint, {likely}"
    ]


def kind_against(recordings: Sequence[Recording], rotary: bool) -> list[str]:
    """Why a simulation of such a joint cannot be that of the recordings; empty where it can.

    Args:
        recordings: Of one joint.
        rotary: Whether the joint of the simulation turns.
    """
    wanted = "rotary" if rotary else "linear"
    others = [one.metadata.motion for one in recordings if one.metadata.motion != wanted]
    if not others:
        return []
    joint = "turns (a hinge)" if rotary else "slides"
    return [
        f"the simulation's joint {joint}, and the recording says motion: {others[0]}: check that it is of this joint, "
        f"or state motion: {wanted} in its metadata"
    ]


def remarks_on(recordings: Sequence[Recording]) -> list[str]:
    """What was found in the data and dealt with, or does no harm: in sentences."""
    remarks = []
    for i, recording in enumerate(recordings):
        prefix = f"recording {i + 1}: " if len(recordings) > 1 else ""
        # A current has no side.
        if recording.metadata.torque_side == "motor" and recording.metadata.torque_unit in ("N·m", "N"):
            ratio = f"multiplied by the gear ratio {recording.metadata.gear_ratio:.4g}"
            remarks.append(f"{prefix}The torque is on the motor side: {ratio}; losses of the gear are in the friction.")
        gaps = _bridged(recording)
        if gaps is not None and gaps.size:
            most = 1e3 * float(gaps.max())
            remarks.append(f"{prefix}{gaps.size} gap(s) in time were bridged, the longest {most:.3g} ms.")
        for finding in check_recording(recording):
            if finding.code == "velocity_scale":
                factor = _velocity_factor(recording)
                remarks.append(
                    f"{prefix}The velocity column is {factor:.2f} times the derivative of position; it was not used."
                )
            elif finding.code == "velocity_mismatch":
                remarks.append(f"{prefix}The velocity column was not used: {finding.message}.")
    return remarks


def _bridged(recording: Recording) -> FloatArray | None:
    """Lengths of the gaps in time where all are short enough to be bridged [s]; None where one is not."""
    step = np.diff(recording.time)
    gaps = step[step > _GAP_PERIODS * recording.sample_period]
    short = not gaps.size or (gaps.max() <= _LONGEST_BRIDGE and gaps.sum() <= _MOST_BRIDGED * recording.duration)
    return gaps if short else None


def _velocity_factor(recording: Recording) -> float:
    """How many times the derivative of position the velocity column is."""
    truth, seen = np.gradient(np.asarray(recording.position), np.asarray(recording.time)), recording.velocity
    assert seen is not None
    return float(np.asarray(seen) @ np.asarray(seen)) / float(truth @ np.asarray(seen))


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
