"""Running sealed arms: each is made, sealed, examined blind in another process, opened and scored."""

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from shutil import rmtree

import msgspec

from fricomp.errors import DiagnosisError
from fricomp.whole_file import write_whole

from ...cases.arm import arm_id, draw_spec, generate_arm, write_arm_answer, write_arm_case
from ..kit.blind import BlindAnswer, diagnose_arm_blind
from ..kit.case import run_cases
from ..kit.store import Row, RowStore
from ..proof.run import derive_salt
from ..proof.seal import SealBook
from ..proof.settings import RunSettings, draw_seeds
from .score import ArmScore, score_arm

_SCORES, _SEALS, _ANSWERS, _DIAGNOSES = "scores.jsonl", "seals.jsonl", "answers", "diagnoses"

_BATCH = 3
"""Arms for each worker between two questions whether to go on."""


def run_arms(
    settings: RunSettings,
    out: Path,
    executor: tuple[Executor, int],
    *,
    duration: float,
    progress: Callable[[], None] = lambda: None,
    go_on: Callable[[], bool] = lambda: True,
) -> list[ArmScore]:
    """Score all arms of a run that the folder does not hold yet.

    Args:
        settings: Which seeds, and the salt.
        out: Folder of the run.
        executor: With the number of its workers.
        duration: Of every recording [s].
        progress: Called after each arm.
        go_on: Asked before each arm; once it says no, the rest is left.
    """
    store = RowStore(out / _SCORES)
    seeds = list(islice(draw_seeds(settings), settings.cases))
    size = _BATCH * executor[1]
    for first in range(0, len(seeds), size):
        batch = {
            f"{seed}, {duration:g} s": (seed, duration, out, settings.salt) for seed in seeds[first : first + size]
        }
        if not batch.keys() <= store.index_by_case().keys() and not go_on():
            break
        run_cases(batch, _make_row, store, executor, progress=progress)
    return read_arm_scores(out)


def _make_row(seed: int, duration: float, out: Path, salt: str) -> Row:
    spec = draw_spec(seed, duration)
    try:
        case = generate_arm(spec)
    except DiagnosisError as error:
        return {"seed": seed, "refused": str(error)}
    folder = write_arm_case(case, out / "cases")
    files = {path.name: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
    path, _ = write_arm_answer(case, out / _ANSWERS, derive_salt(salt, arm_id(spec)))
    seals = SealBook(out / _SEALS)
    seals.seal(arm_id(spec), path.read_bytes())
    blind = diagnose_arm_blind(files)
    write_whole(out / _DIAGNOSES / path.name, blind.diagnosis)
    seals.open(arm_id(spec), path.read_bytes())
    rmtree(folder)  # a seed makes it again
    return {"seed": seed, "id": arm_id(spec), "score": asdict(score_arm(path.read_bytes(), blind))}


def read_arm_scores(out: Path) -> list[ArmScore]:
    """All scores in the folder of a run, by the rules of today where answer and diagnosis are there.

    Raises:
        DiagnosisError: There is none.
    """
    rows = [row for row in RowStore(out / _SCORES).index_by_case().values() if "score" in row]
    if not rows:
        raise DiagnosisError(f"no scores in {out}: run 'fricomp bench arms run --out {out}' first")
    return [_score_again(out, row) for row in rows]


def _score_again(out: Path, row: Row) -> ArmScore:
    score = msgspec.convert(row["score"], ArmScore)
    answer, diagnosis = (out / folder / f"{row['id']}.json" for folder in (_ANSWERS, _DIAGNOSES))
    if not (answer.exists() and diagnosis.exists()):
        return score
    blind = BlindAnswer(diagnosis.read_bytes(), b"", score.seconds, score.error, score.processor_seconds)
    return score_arm(answer.read_bytes(), blind)
