"""Figures of the other methods beside ours, from the ledger of finished draws."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kit.store import RowStore
from .problem import PaperProblem, Reading


@dataclass(frozen=True)
class NoiseFreeFigures:
    """One method on the paper's 41 points without noise.

    Attributes:
        method: Its name.
        starts: Where it starts, in words.
        iterations: Its length; 0 for ours, which ends by itself.
        runs: How many, each from another start.
        converged: How many reported so; all of them where a method reports nothing.
        below_one: Runs with a mean |error| below 1 %.
        median_error: Median over the runs of the mean |error| [%].
        smallest_error: Smallest of these [%].
        largest_error: Largest of these [%].
        from_start: Runs of ours that needed no other start than the one given; 0 for other methods.
    """

    method: str
    starts: str
    iterations: int
    runs: int
    converged: int
    below_one: int
    median_error: float
    smallest_error: float
    largest_error: float
    from_start: int


def summarise_noise_free(ledger: RowStore) -> list[NoiseFreeFigures]:
    """Ours first, then every other method in the ledger; empty without runs of ours."""
    ours = ledger.rows(study="noise_free")
    if not ours:
        return []
    rows = [row for study in ("as_given", "adam", "search") for row in ledger.rows(study=study)]
    rows = [row for row in rows if row.get("reading", "none") == "none"]
    kinds = list(dict.fromkeys(_read_kind(row) for row in rows))
    others = [_collect_noise_free(*kind, [row for row in rows if _read_kind(row) == kind]) for kind in kinds]
    return [_collect_noise_free("fricomp", "a Stribeck velocity, factor 30", 0, ours), *others]


def _read_kind(row: dict[str, Any]) -> tuple[str, str, int]:
    starts = f"all eight, factor {row['spread']:g}" if "spread" in row else "anywhere within the bounds"
    return str(row.get("method", "fricomp, this training alone")), starts, int(row.get("iterations", 0))


def _collect_noise_free(method: str, starts: str, iterations: int, rows: Sequence[dict[str, Any]]) -> NoiseFreeFigures:
    errors = [_compute_mean_error(row) for row in rows]
    return NoiseFreeFigures(
        method=method,
        starts=starts,
        iterations=iterations,
        runs=len(rows),
        converged=sum(row.get("status", "converged") == "converged" for row in rows),
        below_one=sum(error < 1.0 for error in errors),
        median_error=float(np.median(errors)),
        smallest_error=min(errors),
        largest_error=max(errors),
        from_start=sum(row.get("start") == "given" for row in rows),
    )


def _compute_mean_error(row: dict[str, Any]) -> float:
    return PaperProblem().compute_mean_error(row["values"])


def find_best_adam(ledger: RowStore, reading: Reading) -> list[dict[str, Any]]:
    """The training by Adam that came closest, of those of the greatest length; empty without one."""
    rows = ledger.rows(study="adam", reading=reading)
    length = max((int(row["iterations"]) for row in rows), default=0)
    longest = [row for row in rows if row["iterations"] == length]
    return sorted(longest, key=_compute_mean_error)[:1]


def name_of(row: dict[str, Any]) -> str:
    """The method of a row; of the trainings by Adam only the one from the best start is shown."""
    return "Adam from its best start" if row["method"] == "Adam" else str(row["method"])


@dataclass(frozen=True)
class SearchFigures:
    """One competing method beside ours on the same draws.

    Attributes:
        method: Its name.
        iterations: Its length; evaluations for CMA-ES.
        draws: How many draws of this noise reading both have.
        mean_error: Its mean |error| [%].
        our_mean_error: Ours on the same draws [%].
        excess: Median and largest negative log-likelihood above ours [nats].
        our_largest_excess: Ours above theirs, largest [nats].
        missed: Draws on which it ended more than 0.01 nats above ours.
    """

    method: str
    iterations: int
    draws: int
    mean_error: float
    our_mean_error: float
    excess: tuple[float, float]
    our_largest_excess: float
    missed: int


def summarise_searches(ledger: RowStore, reading: Reading) -> list[SearchFigures]:
    """Every competing method and length in the ledger."""
    ours = {row["seed"]: row for row in ledger.rows(study="statistics", reading=reading)}
    rows = ledger.rows(study="search", reading=reading) + ledger.rows(study="adam", reading=reading)
    kinds = sorted({(row["method"], row["iterations"]) for row in rows})
    found = []
    for method, iterations in kinds:
        theirs = [r for r in rows if (r["method"], r["iterations"]) == (method, iterations) and r["seed"] in ours]
        if theirs:
            found.append(_search(method, iterations, theirs, [ours[r["seed"]] for r in theirs]))
    return found


def _search(method: str, iterations: int, rows: list[dict[str, Any]], ours: list[dict[str, Any]]) -> SearchFigures:
    excess = np.array([a["nll"] - b["nll"] for a, b in zip(rows, ours, strict=True)])
    return SearchFigures(
        method=method,
        iterations=iterations,
        draws=len(rows),
        mean_error=float(np.mean([_compute_mean_error(row) for row in rows])),
        our_mean_error=float(np.mean([_compute_mean_error(row) for row in ours])),
        excess=(float(np.median(excess)), float(excess.max())),
        our_largest_excess=float(np.max(-excess)),
        missed=int(np.sum(excess > 0.01)),
    )
