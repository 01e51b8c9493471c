"""Figures of the other methods beside ours, from the ledger of finished draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .ledger import Ledger
from .problem import PaperProblem, Reading

__all__ = ["NoiseFreeFigures", "SearchFigures", "best_adam", "name_of", "summarise_noise_free", "summarise_searches"]


@dataclass(frozen=True)
class NoiseFreeFigures:
    """One method on the paper's 41 points without noise.

    Attributes:
        method: Its name.
        iterations: Its length; 0 for ours, which ends by itself.
        runs: How many, each from another start.
        converged: How many reported so; all of them where a method reports nothing.
        median_error: Median over the runs of the mean |error| [%].
        largest_error: Largest of these [%].
    """

    method: str
    iterations: int
    runs: int
    converged: int
    median_error: float
    largest_error: float


def summarise_noise_free(ledger: Ledger) -> list[NoiseFreeFigures]:
    """Ours first, then every other method in the ledger; empty without runs of ours."""
    ours = ledger.rows(study="noise_free")
    if not ours:
        return []
    rows = ledger.rows(study="search", reading="none") + ledger.rows(study="adam", reading="none")
    kinds = sorted({_kind(row) for row in rows})
    others = [(kind, [row for row in rows if _kind(row) == kind]) for kind in kinds]
    return [_noise_free("fricomp", 0, ours), *(_noise_free(*kind, found) for kind, found in others)]


def _kind(row: dict[str, Any]) -> tuple[str, int]:
    return name_of(row), int(row["iterations"])


def name_of(row: dict[str, Any]) -> str:
    """The method of a row, and where it started if that was chosen."""
    return f"{row['method']} from {row['start']}" if "start" in row else str(row["method"])


def _noise_free(method: str, iterations: int, rows: Sequence[dict[str, Any]]) -> NoiseFreeFigures:
    errors = [float(np.mean(PaperProblem().error_percent(np.array(row["values"])))) for row in rows]
    return NoiseFreeFigures(
        method=method,
        iterations=iterations,
        runs=len(rows),
        converged=sum(row.get("status", "converged") == "converged" for row in rows),
        median_error=float(np.median(errors)),
        largest_error=max(errors),
    )


def best_adam(ledger: Ledger, reading: Reading) -> list[dict[str, Any]]:
    """The training by Adam that came closest, of those of the greatest length; empty without one."""
    rows = ledger.rows(study="adam", reading=reading)
    length = max((int(row["iterations"]) for row in rows), default=0)
    longest = [row for row in rows if row["iterations"] == length]
    return sorted(longest, key=lambda r: float(PaperProblem().error_percent(np.array(r["values"])).mean()))[:1]


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


def summarise_searches(ledger: Ledger, reading: Reading) -> list[SearchFigures]:
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
    problem = PaperProblem()
    excess = np.array([a["nll"] - b["nll"] for a, b in zip(rows, ours, strict=True)])
    return SearchFigures(
        method=method,
        iterations=iterations,
        draws=len(rows),
        mean_error=float(np.mean([problem.error_percent(np.array(r["values"])) for r in rows])),
        our_mean_error=float(np.mean([problem.error_percent(np.array(r["values"])) for r in ours])),
        excess=(float(np.median(excess)), float(excess.max())),
        our_largest_excess=float(np.max(-excess)),
        missed=int(np.sum(excess > 0.01)),
    )
