"""Which joints miss what: one page over the diagnoses of many recordings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fricomp.report import Chart, HeatMap, Panel, ReportPage, Section, Table, write_report

from ..result import Diagnosis
from .wording import VERDICT_TITLES

__all__ = ["write_fleet"]


def write_fleet(table: Table, diagnoses: Sequence[tuple[str, Diagnosis]], folder: Path) -> Path:
    """Write `fleet.html` beside the folders of the diagnoses.

    Args:
        table: One row for each recording.
        diagnoses: Name and diagnosis of each.
        folder: Where.

    Returns:
        The page.
    """
    verdicts = Counter(diagnosis.verdict for _, diagnosis in diagnoses)
    summary = tuple(
        f"{count} of {len(diagnoses)}: {VERDICT_TITLES[verdict]}." for verdict, count in verdicts.most_common()
    )
    chart = _share_chart(diagnoses)
    sections = [Section("Which misses what", (chart,))] if chart is not None else []
    page = ReportPage(f"Diagnosis of {len(diagnoses)} recordings", summary, (*sections, Section("Each", (table,))))
    return write_report(page, folder / "fleet.html")


def _share_chart(diagnoses: Sequence[tuple[str, Diagnosis]]) -> Chart | None:
    effects = sorted({effect.name for _, diagnosis in diagnoses for effect in diagnosis.effects})
    if not effects:
        return None
    shares = np.full((len(diagnoses), len(effects)), np.nan)
    for row, (_, diagnosis) in enumerate(diagnoses):
        for effect in diagnosis.effects:
            shares[row, effects.index(effect.name)] = effect.share
    heat = HeatMap(
        np.arange(float(len(effects))),
        np.arange(float(len(diagnoses))),
        shares,
        "share of the missing energy",
        x_names=tuple(effects),
        y_names=tuple(name for name, _ in diagnoses),
        limits=(0.0, 1.0),
    )
    panel = Panel((heat,), "effect", "recording")
    return Chart("shares", "Share that each effect explains", (panel,), panel_height=180 + 22 * len(diagnoses))
