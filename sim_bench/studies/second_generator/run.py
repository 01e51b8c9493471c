"""One case from its joint to its score: recorded, diagnosed from the files alone in another process, compared."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path

import msgspec

from fricomp.recording import write_recording
from fricomp.whole_file import write_whole

from ..kit.blind import diagnose_blind
from ..kit.case import run_cases
from ..kit.store import Row, RowStore
from .cases import Case
from .joint import PLAIN, write_mjcf
from .motion import PERIOD, make_motion
from .record import sense, simulate
from .score import Score, score_case

_FILES = ("recording.parquet", "joint.xml")
"""What the diagnosis sees."""

_STORE = "scores.jsonl"


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
    write_whole(folder / "joint.xml", write_mjcf(PLAIN, PERIOD, sticks=False))
    return dict(hidden.truth)


def run_case(case: Case, out: Path) -> Score:
    """Record, diagnose and score one case; everything is kept in a folder of its name in `out`."""
    folder = out / case.name
    truth = write_files(case, folder)
    blind = diagnose_blind({name: (folder / name).read_bytes() for name in _FILES})
    write_whole(folder / "diagnosis.json", blind.diagnosis)
    return score_case(case, truth, blind)


def run_all(
    cases: Sequence[Case],
    out: Path,
    executor: tuple[Executor, int],
    *,
    resume: bool = False,
    progress: Callable[[], None] = lambda: None,
) -> tuple[list[Score], list[str]]:
    """Record, diagnose and score all cases.

    Args:
        cases: Which.
        out: Folder of the run.
        executor: With the number of its workers.
        resume: Keep the cases that an earlier run left there, if they were as long.
        progress: Called after each case.

    Returns:
        The scores in the order of the cases, and the commits at which they were measured.
    """
    store = RowStore(out / _STORE)
    calls = {f"{case.name}, {case.duration:g} s": (case, out) for case in cases}
    rows = run_cases(calls, _make_row, store, executor, resume=resume, progress=progress)
    return [msgspec.convert(row["score"], Score) for row in rows], sorted({row["commit"] for row in rows})


def _make_row(case: Case, out: Path) -> Row:
    return {"score": asdict(run_case(case, out))}
