"""Recordings of any file as they are to be written: read, chosen by their names, split into what is usable, checked."""

from collections.abc import Iterator, Sequence
from collections.abc import Mapping as Names
from dataclasses import dataclass, field, replace
from pathlib import Path

import msgspec

from fricomp.errors import RecordingError

from .checks.checks import check_recording
from .conversion import NamedRecording, convert
from .file import is_own, read_content
from .finding import Finding
from .mapping import Mapping, load_mapping, set_row_rate
from .named.joints.joint_name import select_joint
from .named.log import NamedLog, read_named_log
from .parts.parts import find_usable_parts
from .recording import Recording
from .resampling import resample_checked


@dataclass(frozen=True)
class Intake:
    """How the recordings of a file are read.

    Attributes:
        mapping: TOML file, or the name of a mapping in the package; empty where names of columns decide.
        channels: Column by channel, for a log without a mapping in which several could be one.
        rate: Samples a second to which they are resampled [Hz]; None leaves them as they are.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.
        skip_bad_rows: Leave out rows without a number in every column, or with a time that does not advance.

    Raises:
        RecordingError: A rate is not above 0, or columns are named beside a mapping.
    """

    mapping: str = ""
    channels: Names[str, str] = field(default_factory=dict)
    rate: float | None = None
    row_rate: float | None = None
    skip_bad_rows: bool = False

    def __post_init__(self) -> None:
        for option, what, value in (("--rate", "samples", self.rate), ("--row-rate", "rows", self.row_rate)):
            if value is not None and not 0.0 < value < float("inf"):
                raise RecordingError(f"{option} is {value:g}: give {what} a second above 0 [Hz], or leave it out")
        if self.mapping and self.channels:
            raise RecordingError("--channel is for logs without --mapping: say it in the mapping")

    def load_mapping(self) -> Mapping:
        """The mapping, with what is asked for beside it on top.

        Raises:
            RecordingError: There is none of this name, or it says something that a mapping cannot say.
        """
        mapping = load_mapping(self.mapping)
        if self.row_rate is not None:
            mapping = set_row_rate(mapping, self.row_rate)
        return msgspec.structs.replace(
            mapping,
            resample_rate=mapping.resample_rate if self.rate is None else self.rate,
            skip_bad_rows=self.skip_bad_rows or mapping.skip_bad_rows,
        )


def read_source(source: Path, intake: Intake) -> list[NamedRecording]:
    """All recordings of a file, whatever its format.

    Raises:
        RecordingError: It cannot be read; the message says where and what to do.
        MissingExtraError: The package that reads it is not installed.
    """
    if intake.mapping:
        return list(convert(source, intake.load_mapping()))
    if is_own(source) and not intake.channels:
        content = read_content(source, skip_bad_rows=intake.skip_bad_rows, row_rate=intake.row_rate)
        found = [NamedRecording(source.stem, *content)]
    else:
        log = read_named_log(source, intake.channels, row_rate=intake.row_rate)
        joints = [one.metadata.joint for one in log.recordings]
        found = [NamedRecording(one, *each) for one, each in zip(joints, _tell_each(source, log), strict=True)]
    return found if intake.rate is None else [_resample(named, intake.rate) for named in found]


def _tell_each(source: Path, log: NamedLog) -> Iterator[tuple[Recording, tuple[Finding, ...]]]:
    """The recordings of a log, each with what was noted on all of it and on its own joint."""
    of_joint = {one.metadata.joint: f"{source.name}, {one.metadata.joint}: " for one in log.recordings}
    for one in log.recordings:
        others = tuple(start for joint, start in of_joint.items() if joint != one.metadata.joint)
        notes = [note for note in log.notes if not note.startswith(others)]
        yield one, tuple(_find_noted(note.rstrip("."), log.findings) for note in notes)


def _find_noted(note: str, findings: Sequence[Finding]) -> Finding:
    """A note on a log as what was found: as grave as what it tells of the rows, where it tells of them."""
    for finding in findings:
        if finding.message in note:
            return replace(finding, message=note)
    return Finding("named_columns", "note", note, "--inspect tells why")


def _resample(named: NamedRecording, rate: float) -> NamedRecording:
    recording, before = resample_checked(named.recording, rate)
    return replace(named, recording=recording, findings=named.findings + before)


def select_recordings(found: Sequence[NamedRecording], only: Sequence[str]) -> list[NamedRecording]:
    """Those with one of these names, or of the joint that it means; all where no name is given.

    Raises:
        RecordingError: Nothing has one of these names.
    """
    names = [{named.name, *named.name.split("/"), named.recording.metadata.joint} for named in found]
    joints = list(dict.fromkeys(named.recording.metadata.joint for named in found))
    chosen = set[str]()
    for wanted in only:
        meant = wanted if any(wanted in known for known in names) else select_joint(joints, wanted)
        if meant is None:
            valid = ", ".join(named.name for named in found)
            raise RecordingError(f"the source has no recording or joint {wanted!r}: valid are {valid}")
        chosen.add(meant)
    return [named for named, known in zip(found, names, strict=True) if not only or known & chosen]


def split_usable(named: NamedRecording) -> list[NamedRecording]:
    """The usable parts, numbered where there are several; what was left out is told with the first."""
    usable = find_usable_parts(named.recording)
    several = len(usable.parts) > 1
    parts = [
        replace(named, name=f"{named.name}/part_{number}" if several else named.name, recording=part, findings=())
        for number, part in enumerate(usable.parts, 1)
    ]
    told = tuple(Finding("parts", "note", sentence.rstrip("."), "nothing to do") for sentence in usable.sentences)
    return [replace(parts[0], findings=named.findings + told), *parts[1:]]


def note_unusable(named: NamedRecording) -> NamedRecording:
    """The recording with a note on what identify and diagnose will leave out of it; it stays as it is."""
    advice = "identify and diagnose do so by themselves; --split writes what they use"
    said = find_usable_parts(named.recording).sentences
    told = tuple(Finding("parts", "note", one.rstrip("."), advice) for one in said[:1])
    return replace(named, findings=named.findings + told)


def check_named(named: NamedRecording) -> NamedRecording:
    """The recording with what its checks find beside what its source showed, each once."""
    told = {(finding.code, finding.column) for finding in named.findings}
    now = tuple(one for one in _check_as_used(named) if (one.code, one.column) not in told)
    return replace(named, findings=named.findings + now)


def _check_as_used(named: NamedRecording) -> tuple[Finding, ...]:
    """What the checks find; errors that identify and diagnose mend by themselves are warnings."""
    findings = check_recording(named.recording)
    if not any(one.severity == "error" for one in findings):
        return findings
    usable = find_usable_parts(named.recording).kept
    left = {one.code for one in check_recording(usable) if one.severity == "error"}
    return tuple(
        replace(one, severity="warning", advice=f"{one.advice}; identify and diagnose do so by themselves")
        if one.severity == "error" and one.code not in left
        else one
        for one in findings
    )
