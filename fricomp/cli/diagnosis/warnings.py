"""What a diagnosis should be taken with care for: checks of its recordings, and a side of the gear nobody stated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import hypot, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fricomp.diagnosis import Diagnosis, DiagnosisRecord
    from fricomp.recording import Recording

_TOLD = frozenset({"gap", "velocity_scale", "velocity_mismatch"})  # the answer says what was done about them
_ANSWERED = ("torque", "current")  # lone samples that the joint answers stay, the others were left out and told
_ALIKE = 0.1  # relative difference of two factors that are one
_USUAL = 0.1  # that a torque signal is off by for other reasons than a gear
_LEAST_GEAR = 1.5  # ratio below which hardly any stage is built


def distinct_names(paths: Sequence[Path]) -> list[str]:
    """A name for each recording: that of its file, with its folder before it where several are called so."""
    for name in (lambda path: path.stem, lambda path: f"{path.parent.name}/{path.stem}", str):
        names = [name(path) for path in paths]
        often = Counter(names)
        if max(often.values(), default=1) == 1:
            return names
    return names


def diagnosis_warnings(read: Mapping[Path, Recording], diagnosis: Diagnosis) -> tuple[str, ...]:
    """What the checks of the data warn of and the answer does not say itself, in sentences.

    Args:
        read: Every recording, by its file; those that were diagnosed come first.
        diagnosis: The answer, with what it used of them.
    """
    from fricomp.recording import check_recording
    from fricomp.recording.parts.parts import find_usable_parts

    record = diagnosis.record
    said, found = " ".join(record.sentences), []
    used = list(diagnosis.data)
    used += [find_usable_parts(one) for one in list(read.values())[len(used) :]]
    for name, usable in zip(distinct_names(list(read)), used, strict=True):
        where = f"{name}: " if len(read) > 1 else ""
        for finding in check_recording(usable.kept):
            told = finding.code in _TOLD or finding.message in said
            told = told or (finding.code == "spike" and finding.column in _ANSWERED)
            if finding.severity != "note" and not told:
                found.append(where + finding.caution)
    factor = _common_factor(record)
    advice = None if factor is None else _suspect_gear(factor, list(read.values()))
    return (*found, advice) if advice is not None else tuple(found)


def _common_factor(record: DiagnosisRecord) -> float | None:
    """What inertia and gravity of the simulation are both multiplied by; None where there is no such factor."""
    moved = {change.name: (change.given, change.refitted.value) for change in record.changes}
    if not {"inertia", "gravity_cos", "gravity_sin"} <= set(moved):
        return None
    (cosine, new_cosine), (sine, new_sine) = moved["gravity_cos"], moved["gravity_sin"]
    size, inertia = hypot(cosine, sine), moved["inertia"][1] / moved["inertia"][0]
    if size == 0.0:
        return None
    gravity = (new_cosine * cosine + new_sine * sine) / size**2
    away = hypot(new_cosine - gravity * cosine, new_sine - gravity * sine) / size
    if gravity <= 0.0 or away > _ALIKE * gravity or abs(inertia / gravity - 1.0) > _ALIKE:
        return None
    factor = sqrt(inertia * gravity)
    return None if 1.0 - _USUAL < factor < 1.0 + _USUAL else factor


def _suspect_gear(factor: float, recordings: Sequence[Recording]) -> str | None:
    """What a gear has to do with one factor on inertia and gravity; None where none makes so small a factor."""
    ratios = sorted({one.metadata.gear_ratio for one in recordings if one.metadata.gear_ratio is not None})
    stated = f"gear_ratio {', '.join(f'{ratio:.4g}' for ratio in ratios)}" if ratios else "no gear_ratio"
    both = f"Careful: inertia and gravity are both {factor:.3g} times those of the simulation"
    if any(one.metadata.torque_side == "motor" for one in recordings):
        return f"{both}, as a wrong gear ratio makes them: check the {stated} of the recording."
    if 1.0 / _LEAST_GEAR < factor < _LEAST_GEAR:
        return None
    return (
        f"{both}, as torque of the motor side of a gear makes them (the recording states {stated}): unless the torque "
        "acts on the joint side, state torque_side: motor and the gear_ratio in its metadata."
    )
