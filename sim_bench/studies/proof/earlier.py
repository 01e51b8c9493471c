"""The scored runs before this one, from the log, so that none is silently repeated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fricomp.report import format_markdown_table

__all__ = ["format_earlier"]

_FIGURES = {
    "false name where nothing is missing": ("false name where nothing is missing", "named where nothing is missing"),
    "right name, rich": ("right name, rich motion, ENR ≥ 0.2",),
    "right name, Fourier": ("right name, 60 s Fourier motion, ENR ≥ 0.5",),
    "two effects": ("two effects, separable, ENR ≥ 0.3, both and nothing else",),
    "outside called unknown": ("outside the catalogue called unknown, ENR ≥ 1",),
}
"""Figures by the names that they have had."""

_RULES = """Every figure is by the rules of its day. Names of parameters that the simulation has right count as
false since run 26, a neighbour that nobody can name has its own figure since run 27: by that, run 12 has 4 false
names, run 17 has 2. Up to the 25th run every effect met one friction core only; up to the 26th the simulation was
exact wherever physics was missing, friction was stated only where none was, and only what depended on the temperature
cooled down."""


def format_earlier(entries: Sequence[Mapping[str, Any]], run: int) -> str:
    """A section of the page: every scored run with a smaller number, with what was measured and why it ended.

    Args:
        entries: Of the log, oldest first; `reason` of an entry `closed` says why a run ended.
        run: Number of the run that the page is about.
    """
    earlier = sorted({entry["run"] for entry in entries if entry["run"] < run})
    if not earlier:
        return ""
    head = ["run", "diagnosis", "cases", *_FIGURES, "why it ended"]
    rows = [_row([entry for entry in entries if entry["run"] == number]) for number in earlier]
    table = format_markdown_table(head, rows)
    return f"## Earlier scored runs\n\n{_RULES}\n\n{table}\n\nTheir scores and seals stand in `docs/proof/run-N`."


def _row(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    last = next((entry for entry in reversed(entries) if "figures" in entry), None)
    figures: Mapping[str, str] = last["figures"] if last else {}
    reason = next((entry["reason"] for entry in entries if entry["event"] == "closed"), "–")
    measured = [_short(next((figures[name] for name in names if name in figures), "–")) for names in _FIGURES.values()]
    count = str(last["cases"]) if last else "0"
    return [str(entries[0]["run"]), f"`{entries[0]['tree'][:12]}`", count, *measured, reason]


def _short(value: str) -> str:
    """A share with its counts, without its interval."""
    return value.split(";", maxsplit=1)[0].replace(" (", ", ").rstrip(")")
