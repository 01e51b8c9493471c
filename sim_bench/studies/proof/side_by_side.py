"""Two runs of the same cases side by side: which answers differ, and by how much numbers moved."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fricomp.errors import DiagnosisError

from ..kit.score import read_diagnosis
from ..kit.store import RowStore
from .run import DIAGNOSES, SCORES

_WIDTH = 3.92
"""Width of a 95 % interval in standard deviations."""


@dataclass(frozen=True)
class AnswerPair:
    """The answers of two runs to one case.

    Attributes:
        case: Its name.
        truth: What was concealed; empty where the scores do not say it.
        before: Verdict and names of the first run.
        after: Those of the second run.
        shift: Largest move of a parameter that both name, in standard deviations of the first run's interval; 0 where
            both name none.
        seconds: Time of each diagnosis [s]; 0 where the scores do not say it.
    """

    case: str
    truth: str
    before: tuple[str, ...]
    after: tuple[str, ...]
    shift: float
    seconds: tuple[float, float]

    @property
    def differs(self) -> bool:
        """Whether verdict or names differ."""
        return self.before != self.after


def compare_runs(first: Path, second: Path) -> list[AnswerPair]:
    """Compare the answers to the cases that both folders hold, by name of the case.

    Args:
        first: Folder of a run.
        second: Folder of another run of the same cases.

    Raises:
        DiagnosisError: They have no case in common.
    """
    both = sorted(_list_answers(first) & _list_answers(second))
    if not both:
        raise DiagnosisError(
            f"{first} and {second} have no diagnosed case in common: run both with the same --cases and --first-seed"
        )
    rows = [RowStore(folder / SCORES).index_by_case() for folder in (first, second)]
    pairs = []
    for case in both:
        old, new = (_read(folder, case) for folder in (first, second))
        taken = [float(row.get(case, {}).get("seconds", 0.0)) for row in rows]
        truth = next((str(row[case]["truth"]) for row in rows if case in row), "")
        pairs.append(AnswerPair(case, truth, _name(old), _name(new), _measure_shift(old, new), (taken[0], taken[1])))
    return pairs


def _list_answers(folder: Path) -> set[str]:
    return {path.stem for path in (folder / DIAGNOSES).glob("*.json") if path.stat().st_size}


def _read(folder: Path, case: str) -> dict[str, Any]:
    return read_diagnosis((folder / DIAGNOSES / f"{case}.json").read_bytes())


def _name(record: dict[str, Any]) -> tuple[str, ...]:
    """The verdict, and the names in an order of their own."""
    return (str(record["verdict"]), *sorted(str(effect["name"]) for effect in record["effects"]))


def _measure_shift(old: dict[str, Any], new: dict[str, Any]) -> float:
    after = {effect["name"]: effect["parameters"] for effect in new["effects"]}
    shifts = [0.0]
    for effect in old["effects"]:
        for name, quantity in effect["parameters"].items():
            other, (low, high) = after.get(effect["name"], {}).get(name), quantity["ci95"]
            if other is not None and low is not None and high is not None and high > low:
                shifts.append(abs(other["value"] - quantity["value"]) / (high - low) * _WIDTH)
    return max(shifts)
