"""One public set through the diagnosis, and what came of it beside what was expected."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from fricomp.arm.payload import diagnose_payload
from fricomp.diagnosis import Diagnosis, DiagnosisRecord, Quantity, diagnose, load_diagnosis
from fricomp.diagnosis.report import derive_parameters, write_diagnosis
from fricomp.errors import FricompError
from fricomp.recording import read_public
from fricomp.whole_file import write_whole

from ..kit.case import run_cases
from ..kit.store import Row, RowStore
from .arm import ARMS, arm_xml
from .cases import RealCase

_STORE = "outcomes.jsonl"


@dataclass(frozen=True)
class RealOutcome:
    """What the diagnosis said of one case.

    Attributes:
        case: Which.
        record: The answer; None where there was none.
        error: Why there was none.
        seconds: Wall-clock time [s].
    """

    case: RealCase
    record: DiagnosisRecord | None
    error: str
    seconds: float

    @property
    def named(self) -> frozenset[str]:
        """Effects that were named."""
        return frozenset(effect.name for effect in self.record.effects) if self.record is not None else frozenset()

    @property
    def names(self) -> frozenset[str]:
        """Effects that were named or cannot be told from those."""
        effects = self.record.effects if self.record is not None else ()
        return frozenset(name for effect in effects for name in (effect.name, *effect.indistinguishable_from))

    @property
    def reached(self) -> bool | None:
        """Whether it came out as expected, which it did not without an answer; None where nothing was promised."""
        if not (self.case.expected or self.case.refuted):
            return None
        if self.record is None or self.named & set(self.case.refuted):
            return False
        return not self.case.expected or bool(self.names & set(self.case.expected))

    @property
    def found(self) -> frozenset[str]:
        """Which of the effects that the case lists without promising them were named or cannot be told from those."""
        return self.names & set(self.case.listed)

    @property
    def is_listed(self) -> bool:
        """Whether effects are known of a case that promises none."""
        return self.reached is None and bool(self.case.listed)

    @property
    def missed(self) -> bool:
        """Whether what is known did not come out."""
        return not self.reached and not (self.is_listed and self.found)

    @property
    def others(self) -> frozenset[str]:
        """What was named that nobody knows to be there."""
        return self.named - self.case.effects

    @property
    def found_values(self) -> tuple[tuple[str, float, Quantity], ...]:
        """Name, known value and found value of each parameter that the case knows, of the strongest effect with it."""
        found: dict[str, Quantity] = {}
        for effect in self.record.effects if self.record else ():
            found = {**derive_parameters(effect), **found}
        return tuple((name, value, found[name]) for name, value in self.case.known if name in found)

    @property
    def strongest_rejected(self) -> str:
        """The best-fitting other explanation and why it was refused, in one sentence; empty where there is none.

        One that cannot be told from what was named is not refused by this, even where something simpler came first.
        """
        if self.record is None:
            return ""
        rivals = [rival for rival in self.record.rivals if rival.refused and not self.names & set(rival.effects)]
        if not rivals:
            return ""
        best = max(rivals, key=lambda rival: rival.gain)
        return f"{' + '.join(best.effects)}: {best.refused}"


def run_all(
    cases: Sequence[RealCase],
    out: Path,
    executor: tuple[Executor, int],
    *,
    seed: int = 0,
    resume: bool = False,
    progress: Callable[[], None] = lambda: None,
) -> tuple[list[RealOutcome], list[str]]:
    """Diagnose the cases and write a folder for each.

    Args:
        cases: Which.
        out: Folder; each case gets its own in it.
        executor: With the number of its workers.
        seed: Of the diagnoses.
        resume: Keep the cases that an earlier run with this seed left there.
        progress: Called after each case.

    Returns:
        What came out, in the order of the cases, and the commits at which it was measured.
    """
    store = RowStore(out / _STORE)
    calls = {f"{case.name}, seed {seed}": (case, out, seed) for case in cases}
    rows = run_cases(calls, _make_row, store, executor, resume=resume, progress=progress)
    return [_read_outcome(case, row, out) for case, row in zip(cases, rows, strict=True)], sorted(
        {row["commit"] for row in rows}
    )


def _make_row(case: RealCase, out: Path, seed: int) -> Row:
    outcome = _diagnose(case, out / case.name, seed)
    return {"error": outcome.error, "seconds": outcome.seconds}


def _read_outcome(case: RealCase, row: Row, out: Path) -> RealOutcome:
    record = None if row["error"] else load_diagnosis(out / case.name / "diagnosis.json")
    return RealOutcome(case, record, row["error"], row["seconds"])


def _write_arm(name: str, place: Path) -> Path:
    """The arm's kinematics as a file, for the diagnosis and for whoever repeats it by hand."""
    path = place / "arm.xml"
    write_whole(path, arm_xml(name, ARMS[name]))
    return path


def _diagnose(case: RealCase, place: Path, seed: int) -> RealOutcome:
    start = time.perf_counter()
    try:
        named = [(source, recording) for source in case.sources for recording in read_public(source)]
        names = [f"{source}/{one.metadata.joint}" if case.arm else source for source, one in named]
        simulation = _write_arm(case.arm, place) if case.arm else None
        series = [one for _, one in named]
        diagnosis: Diagnosis = (
            diagnose(series, seed=seed, names=names)
            if simulation is None
            else diagnose_payload(series, simulation, names)
        )
    except FricompError as error:
        return RealOutcome(case, None, str(error), time.perf_counter() - start)
    seconds = time.perf_counter() - start
    write_diagnosis(diagnosis, place, facts={"recordings": ", ".join(case.sources), "seed": str(seed)})
    return RealOutcome(case, diagnosis.record, "", seconds)
