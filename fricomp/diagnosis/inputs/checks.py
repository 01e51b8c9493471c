"""Data checks before any physics: what makes a recording unfit, in sentences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.recording import Finding, Recording, check_recording, resample
from fricomp.recording.checks.motion_kind import SHOWS_NO_SLIDING, find_one_way
from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.checks.torque_sensor import find_torque_gain
from fricomp.recording.checks.unit_checks import find_velocity_mismatch
from fricomp.recording.parts.parts import LeftOut, UsableParts, find_usable_parts

from .past import Past
from .stretches import Stretch, choose_stretches
from .track import FloatArray

PART_OF = "part_of"
"""Key of a part's metadata for the number of the recording that it is of, counted from 0."""

_TOLD = (find_velocity_mismatch, find_one_way, find_torque_gain)
"""Checks of each part whose findings are remarks; all of them were made of the whole recording."""
_FATAL_WARNINGS = SHOWS_NO_SLIDING | {"one_way", "degrees_likely"}
_LEAST = 2.0  # [s] of a part; shorter ones hold no stretch that can be held out
_MOST_PARTS = 12  # of one recording: the longest; the kernel runs sixteen joints a call
_OTHER_JOINT = 15.0  # times a simulation's inertia that no payload explains; the base goes up to 20
_ONE_RATE = 1.5  # quotient of two sample rates up to which they share one grid
_LONGEST_BRIDGE = 0.03  # [s] shorter than a row of the residual
_MOST_BRIDGED = 0.01  # of the time
_NOT_SEARCHED = "of which stretches from all of its time were searched"


class Usable(NamedTuple):
    """Recordings that can be diagnosed.

    Attributes:
        recordings: Usable parts, in order; each names the recording that it is of under `PART_OF` of its metadata. Of
            recordings that are longer than what is searched, stretches of them.
        remarks: What was left out and why, in sentences.
        reasons: Why nothing can be diagnosed; empty where something can.
        data: What is usable of each recording, for the report.
        pasts: How the joint was driven over what each is a stretch of; None where it is all of it.
        whole: All usable parts, where some of them are not searched; else empty.
    """

    recordings: list[Recording]
    remarks: list[str]
    reasons: list[str]
    data: tuple[UsableParts, ...] = ()
    pasts: tuple[Past | None, ...] = ()
    whole: tuple[Recording, ...] = ()


def take_usable(recordings: Sequence[Recording], joint: str | None) -> Usable:
    """Cut recordings into their usable parts; what is wrong with one of several costs that one alone.

    Args:
        recordings: Of one joint.
        joint: Its name; None for any.
    """
    kept: list[Recording] = []
    faults: list[str] = []
    data: list[UsableParts] = []
    for number, recording in enumerate(recordings):
        usable = find_usable_parts(recording)
        data.append(usable)
        against = _reasons_against_one(usable.kept, joint)
        faults += [_name_one(recordings, number) + reason for reason in against]
        if not against:
            parts = _longest_parts(usable.parts)
            kept += [one.with_metadata(extra={**one.metadata.extra, PART_OF: number}) for one in parts]
    if not kept:
        return Usable([], [], faults, tuple(data))
    kept, told = _at_one_rate(kept)
    used = list(dict.fromkeys(one.metadata.extra[PART_OF] for one in kept))
    sources = [[one for one in kept if one.metadata.extra[PART_OF] == number] for number in used]
    stretches = choose_stretches(sources)
    for number, parts, few in zip(used, sources, stretches, strict=True):
        data[number] = _leave_rest(data[number], parts, few)
    remarks = [_name_one(recordings, number) + one for number in used for one in data[number].sentences]
    searched = [one for few in stretches for one in few]
    return Usable(
        [one.recording for one in searched],
        [*remarks, *(f"Left out: {fault}." for fault in faults), *told],
        [],
        tuple(data),
        tuple(one.past for one in searched),
        tuple(kept) if sum(len(one.recording) for one in searched) < sum(map(len, kept)) else (),
    )


def _name_one(recordings: Sequence[Recording], number: int) -> str:
    return f"recording {number + 1}: " if len(recordings) > 1 else ""


def _leave_rest(usable: UsableParts, parts: Sequence[Recording], stretches: Sequence[Stretch]) -> UsableParts:
    """What is usable, less what is not searched."""
    rows = sum(map(len, parts)) - sum(len(one.recording) for one in stretches)
    if not rows:
        return usable
    rest = LeftOut("rows of a long recording, " + _NOT_SEARCHED, rows, rows * parts[0].sample_period)
    return replace(usable, parts=tuple(one.recording for one in stretches), left_out=(*usable.left_out, rest))


def name_parts(parts: Sequence[Recording], names: Sequence[str]) -> tuple[str, ...]:
    """What each usable part is called: as its recording, with a number where there are several.

    Args:
        parts: As `take_usable` gives them.
        names: Of all recordings.
    """
    numbers = [part.metadata.extra[PART_OF] for part in parts]
    return tuple(
        f"{names[number]} part {numbers[: i + 1].count(number)}" if numbers.count(number) > 1 else names[number]
        for i, number in enumerate(numbers)
    )


def _longest_parts(parts: Sequence[Recording]) -> list[Recording]:
    """The longest parts, in order."""
    long = [part for part in parts if part.duration >= _LEAST] or [max(parts, key=lambda part: part.duration)]
    chosen = sorted(long, key=lambda part: -part.duration)[:_MOST_PARTS]
    return [part for part in long if any(part is one for one in chosen)]


def _at_one_rate(recordings: Sequence[Recording]) -> tuple[list[Recording], list[str]]:
    """The recordings at the lowest of their rates, where these are far apart."""
    periods = [recording.sample_period for recording in recordings]
    if max(periods) <= _ONE_RATE * min(periods):
        return list(recordings), []
    rate = 1.0 / max(periods)
    changed = [resample(one, rate) if one.sample_period * _ONE_RATE < max(periods) else one for one in recordings]
    return changed, [
        f"Sample rates go from {rate:.4g} to {1.0 / min(periods):.4g} Hz; all was brought to {rate:.4g} Hz."
    ]


def reasons_against(recordings: Sequence[Recording], joint: str | None) -> list[str]:
    """Why these recordings cannot be diagnosed; empty where they can."""
    reasons = []
    for i, recording in enumerate(recordings):
        prefix = f"recording {i + 1}: " if len(recordings) > 1 else ""
        reasons += [prefix + reason for reason in _reasons_against_one(recording, joint)]
    return reasons


def _reasons_against_one(recording: Recording, joint: str | None) -> list[str]:
    reasons = []
    name = recording.metadata.joint
    if joint is not None and name not in (joint, "joint", ""):
        reasons.append(f"it was made on joint {name!r}, not on {joint!r}")
    return reasons + [str(finding) for finding in check_recording(recording) if _fatal(finding)]


def _fatal(finding: Finding) -> bool:
    """Errors, and what would only give physics names that a unit makes."""
    return finding.severity == "error" or finding.code in _FATAL_WARNINGS


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


def remarks_on(recordings: Sequence[Recording], names: Sequence[str] = ("",)) -> list[str]:
    """What was found in the data and dealt with, or does no harm: in sentences.

    Args:
        recordings: Usable parts of what was given.
        names: What each of them is called; of one alone it is not said.
    """
    remarks = []
    for recording, name in zip(recordings, names, strict=True):
        prefix = f"{name}: " if len(recordings) > 1 else ""
        # A current has no side.
        if recording.metadata.torque_side == "motor" and recording.metadata.torque_unit in ("N·m", "N"):
            ratio = f"multiplied by the gear ratio {recording.metadata.gear_ratio:.4g}"
            remarks.append(f"{prefix}The torque is on the motor side: {ratio}; losses of the gear are in the friction.")
        gaps = _bridged(recording)
        if gaps is not None and gaps.size:
            most = 1e3 * float(gaps.max())
            remarks.append(f"{prefix}{gaps.size} gap(s) in time were bridged, the longest {most:.3g} ms.")
        for finding in (one for check in _TOLD for one in check(recording)):
            if finding.code == "velocity_scale":
                factor = _velocity_factor(recording)
                remarks.append(
                    f"{prefix}The velocity column is {factor:.2f} times the derivative of position; it was not used."
                )
            elif finding.code in ("one_way_turns", "torque_gain"):
                remarks.append(f"{prefix}{finding.message[0].upper()}{finding.message[1:]}.")
            elif finding.code == "velocity_mismatch":
                remarks.append(f"{prefix}The velocity column was not used: {finding.message}.")
    return remarks


def _bridged(recording: Recording) -> FloatArray | None:
    """Lengths of the gaps in time where all are short enough to be bridged [s]; None where one is not."""
    step = np.diff(recording.time)
    gaps = step[step > find_gap_length(recording)]
    short = not gaps.size or (gaps.max() <= _LONGEST_BRIDGE and gaps.sum() <= _MOST_BRIDGED * recording.duration)
    return gaps if short else None


def _velocity_factor(recording: Recording) -> float:
    """How many times the derivative of position the velocity column is."""
    truth, seen = np.gradient(np.asarray(recording.position), np.asarray(recording.time)), recording.velocity
    assert seen is not None
    return float(np.asarray(seen) @ np.asarray(seen)) / float(truth @ np.asarray(seen))
