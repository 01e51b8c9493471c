"""What of a recorded motion is identified: its motion blocks, on the joint side, part by part between gaps."""

import os
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording import Finding, Recording, check_recording, raise_errors, read_blocks
from fricomp.recording.checks.motion_kind import SHOWS_NO_SLIDING
from fricomp.recording.checks.timing_checks import locate_gaps
from fricomp.recording.checks.torque_causes import find_delay
from fricomp.recording.csv_file import FileContent
from fricomp.recording.file import is_own, read_content
from fricomp.recording.parts.parts import UsableParts, find_usable_parts
from fricomp.untrusted import parse_json

_MOTION = "motion"
"""Kind of the blocks that `fricomp calibrate --motion` writes beside those of its preparation."""
_FEWEST = 50
"""Samples below which a part is not filtered: the zero-phase filters need some before and after what is kept."""
_SHATTERED = 4
"""The same rows times this are in a recording that is refused where no stretch has as many."""
_MARGINS = 4.0
"""Margins below which a part is not filtered: two of them are left out at its ends."""


class MotionRecording(NamedTuple):
    """A recording as it is identified.

    Attributes:
        recording: Torque on the joint side.
        findings: Of the checks; none is an error.
        notes: Sentences on what was chosen and converted.
        data: What was used of it and what was not.
    """

    recording: Recording
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]
    data: UsableParts


class MotionParts(NamedTuple):
    """A recording cut at its gaps.

    Attributes:
        parts: Those that are long enough to be filtered, in order.
        short: Durations of the others [s].
    """

    parts: tuple[Recording, ...]
    short: tuple[float, ...]

    @property
    def notes(self) -> tuple[str, ...]:
        """What to say about gaps; nothing where there are none."""
        if len(self.parts) + len(self.short) < 2:
            return ()
        covered = sum(part.duration for part in self.parts)
        text = f"Gaps in time: {len(self.parts)} parts, {covered:.4g} s in all, were filtered each on its own"
        if self.short:
            text += f"; {len(self.short)} too short for that, {sum(self.short):.3g} s in all, were left out"
        return (f"{text}.",)


class _Label(msgspec.Struct):
    kind: str = ""


def read_motion_recording(source: Recording | str | os.PathLike[str]) -> MotionRecording:
    """Read a recording for identification: its usable rows, and of its blocks the motion; its torque at the joint.

    Raises:
        RecordingError: The file cannot be read, or a check finds an error in what is used of it.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    content, file = _read_content(source)
    chosen, notes = _choose_blocks(content.recording, file)
    usable = find_usable_parts(chosen)
    chosen = usable.kept
    _refuse_shattered(file, usable)
    findings = content.findings + tuple(one for one in check_recording(chosen) if one.code != "gap")
    raise_errors(findings, str(file))
    idle = [one for one in findings if one.code in SHOWS_NO_SLIDING]
    if idle:
        raise RecordingError(f"{file}: {idle[0]}")
    chosen, late = _remove_delay(chosen, findings)
    on_joint = chosen.on_joint_side()
    return MotionRecording(
        on_joint, findings, (*notes, *usable.sentences, *late, *_describe_side(chosen, on_joint)), usable
    )


def _refuse_shattered(file: Path | str, usable: UsableParts) -> None:
    """Refuse a recording in which every stretch between gaps is too short: what one of them shows is no motion.

    Raises:
        RecordingError: It is one.
    """
    if len(usable.parts) > 1 or len(usable.kept) >= _FEWEST or usable.rows < _SHATTERED * _FEWEST:
        return
    period = usable.duration / max(usable.rows - 1, 1)
    raise RecordingError(
        f"{file}: its {usable.rows} rows lie in stretches of at most {len(usable.kept)} between gaps in time, too "
        "short to be filtered: where they were sampled evenly and stamped when they arrived, give their rate: 'fricomp "
        f"convert LOG --row-rate {1.0 / period:.4g} --out joint.csv'"
    )


def _remove_delay(recording: Recording, findings: tuple[Finding, ...]) -> tuple[Recording, tuple[str, ...]]:
    """The recording with a torque that acts at its stamp, where the checks found one that acts later."""
    late = any(one.code == "late_torque" for one in findings)
    delay = find_delay(recording) if late else None
    if delay is None:
        return recording, ()
    moved = np.interp(np.asarray(recording.time) - delay, recording.time, recording.torque)
    note = f"Torque delay: the torque acts {1e3 * delay:.3g} ms after its stamp, which was taken off first."
    return recording.with_channels(torque=moved), (note,)


def _read_content(source: Recording | str | os.PathLike[str]) -> tuple[FileContent, Path | str]:
    """A recording with what was wrong with its file, and its file; of one that has none, what to call it."""
    if isinstance(source, Recording):
        return FileContent(source, ()), f"recording of joint {source.metadata.joint!r}"
    return read_content(Path(source)), Path(source)


def split_motion(recording: Recording, *, shortest_gap: float, margin: float) -> MotionParts:
    """Cut a recording at its gaps.

    Args:
        recording: Samples at any times.
        shortest_gap: Gaps up to this one are bridged: a straight line over them loses nothing that is kept [s].
        margin: Time that is left out at both ends of each part [s].
    """
    gaps = locate_gaps(recording, shortest_gap) + 1
    edges = [0, *gaps.tolist(), len(recording)]
    parts, short = [], []
    for start, stop in pairwise(edges):
        duration = float(recording.time[stop - 1] - recording.time[start])
        if len(edges) == 2 or (stop - start >= _FEWEST and duration >= _MARGINS * margin):
            parts.append(recording.rows(slice(start, stop)))
        else:
            short.append(duration)
    return MotionParts(tuple(parts), tuple(short))


def _choose_blocks(recording: Recording, path: Path | str) -> tuple[Recording, tuple[str, ...]]:
    """The rows of the motion blocks, and a sentence on it; all rows where there is no such block."""
    has_blocks = not isinstance(path, str) and is_own(path) and path.suffix.lower() not in (".parquet", ".pq")
    blocks = read_blocks(path) if has_blocks else ()
    if not blocks:
        return recording, ()
    kinds = [_read_kind(block.label) for block in blocks]
    motions = [block for block, kind in zip(blocks, kinds, strict=True) if kind == _MOTION]
    others = ", ".join(dict.fromkeys(kind for kind in kinds if kind and kind != _MOTION))
    if not motions:
        named = f" ({others})" if others else ""
        return recording, (f"Blocks: all {len(blocks)} of the recording were used{named}; none of them is a motion.",)
    rows = np.concatenate([np.arange(block.start, block.stop) for block in motions])
    left_out = f"; the others ({others}) were left out" if others else ""
    which = f"{len(motions)} of {len(blocks)}, the motion" + ("s" if len(motions) > 1 else "")
    note = f"Blocks: {which}, {len(rows)} of {len(recording)} samples, were used{left_out}."
    return recording.rows(rows), (note,)


def _read_kind(label: str) -> str:
    """What a block is, from the label that a sweep gives it; empty for labels of others."""
    try:
        return parse_json(label, _Label).kind
    except msgspec.MsgspecError:
        return ""


def _describe_side(read: Recording, on_joint: Recording) -> tuple[str, ...]:
    """A sentence where the torque was recorded on the motor side."""
    meta = read.metadata
    if meta.torque_side == "joint":
        return ()
    if np.array_equal(read.torque, on_joint.torque) and meta.gear_ratio != 1.0:
        return (f"Torque side: the torque is in {meta.torque_unit}, which no gear changes; it was taken as it is.",)
    return (
        f"Torque side: recorded at the motor, brought to the joint by the gear ratio {meta.gear_ratio:g}; inertia and "
        "friction are those at the joint, losses of the gear among them.",
    )
