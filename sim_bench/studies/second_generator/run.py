"""One case from its joint to its score: recorded, diagnosed from the files alone in another process, compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec

from fricomp.errors import DiagnosisError
from fricomp.recording import write_recording
from fricomp.whole_file import whole_file

from ..diagnosis_version import diagnosis_version
from ..proof.blind import BlindAnswer, diagnose_blind
from .cases import Case
from .joint import PLAIN, write_mjcf
from .motion import PERIOD, make_motion
from .record import sense, simulate
from .score import Score, score_case

__all__ = ["run_case", "write_files"]

_FILES = ("recording.parquet", "joint.xml")


def write_files(case: Case, folder: Path) -> dict[str, float]:
    """Write the recording and the ordinary simulation of a case.

    Returns:
        Known parameters of what the simulation leaves out, by name.
    """
    motion = make_motion(case.motion, case.duration, case.seed)
    hidden = case.truth.build(motion)
    folder.mkdir(parents=True, exist_ok=True)
    recording = sense(simulate(hidden, motion), hidden, case.seed, velocity=case.velocity)
    write_recording(recording, folder / "recording.parquet")
    (folder / "joint.xml").write_text(write_mjcf(PLAIN, PERIOD, sticks=False), encoding="utf-8")
    return dict(hidden.truth)


def run_case(case: Case, out: Path, *, resume: bool = False) -> Score:
    """Record, diagnose and score one case; everything is kept in a folder of its name.

    Args:
        case: Which.
        out: Folder of the run.
        resume: Take the score that an earlier run left there, if it is of this very case and diagnosis.
    """
    folder = out / case.name
    kept = folder / "score.json"
    if resume and kept.exists():
        score = msgspec.json.decode(kept.read_bytes(), type=Score)
        if (score.case, score.diagnosis) == (case, diagnosis_version()):
            return score
    truth = write_files(case, folder)
    blind: BlindAnswer = diagnose_blind({name: (folder / name).read_bytes() for name in _FILES})
    (folder / "diagnosis.json").write_bytes(blind.diagnosis)
    score = replace(score_case(case, truth, blind), diagnosis=diagnosis_version())
    with whole_file(kept, DiagnosisError) as part:
        part.write_bytes(msgspec.json.format(msgspec.json.encode(score), indent=1) + b"\n")
    return score
