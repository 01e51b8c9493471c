"""Which joints miss what: rows, table and page over the diagnoses of many joints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.report import Chart, HeatMap, Panel, ReportPage, Section, Table, write_report

from ..record.result import DiagnosisRecord
from .settings import REPORT
from .wording import VERDICT_TITLES

_Row = Mapping[str, Any]


def build_fleet_row(record: DiagnosisRecord) -> dict[str, Any]:
    """What a fleet's table keeps of a diagnosis; names are joined by a plus sign, alias sets by a bar."""
    held, effects, errors = record.heldout, record.effects, record.errors
    return {
        "verdict": record.verdict,
        "named": "+".join(effect.name for effect in effects),
        "sets": "+".join("|".join(effect.indistinguishable_from) for effect in effects),
        "shares": [float(effect.share) for effect in effects],
        "torque_error_before": errors.before.torque.rms if errors is not None else None,
        "torque_error": errors.written.torque.rms if errors is not None else None,
        "rmse_before": held.rmse_before if held is not None else None,
        "rmse_after": held.rmse_after if held is not None else None,
        "noise_floor": held.noise_floor if held is not None else None,
        "unit": held.unit if held is not None else "",
        "noise_ratio": record.noise_ratio,
    }


def build_fleet_table(rows: Sequence[_Row]) -> Table:
    """One line a joint."""
    columns = ("joint", "verdict", "named", "held-out torque error", "report")
    return Table(columns, tuple(_format_row(row) for row in rows))


def _format_row(row: _Row) -> tuple[str, ...]:
    name = str(row["name"])
    if row["error"]:
        return (name, "failed", "–", str(row["error"]), "–")
    error = "–"
    if row.get("torque_error_before") is not None:
        error = f"{row['torque_error_before']:.3g} → {row['torque_error']:.3g} {row['unit']}"
    return (name, str(row["verdict"]), str(row["named"]).replace("+", ", ") or "–", error, f"{name}/report.html")


def write_fleet(rows: Sequence[_Row], folder: Path) -> Path:
    """Write `fleet.html` beside the folders of the diagnoses.

    Args:
        rows: Of `build_fleet_row`, each with `name` and `error`.
        folder: Where.

    Returns:
        The page.
    """
    done = [row for row in rows if not row["error"]]
    verdicts = Counter(str(row["verdict"]) for row in done)
    summary = [f"{count} of {len(rows)}: {VERDICT_TITLES[verdict]}." for verdict, count in verdicts.most_common()]
    if len(done) < len(rows):
        summary.append(f"{len(rows) - len(done)} of {len(rows)} failed; the table says why.")
    named = [row for row in done if row["named"]]
    sections = [Section("How often each is missing", (_build_count_table(done),))] if named else []
    chart = _draw_shares(named[: REPORT.joints])
    sections += [Section("Which misses what", (chart,))] if chart is not None else []
    links = {str(row["name"]): f"{row['name']}/report.html" for row in done}
    sections.append(Section("Each", (replace(build_fleet_table(rows), links=links, filtered=True),)))
    bad = sum(bool(row["error"]) or row.get("verdict") == "bad_data" for row in rows)
    return write_report(
        ReportPage(
            f"Diagnosis of {len(rows)} joints",
            tuple(summary),
            tuple(sections),
            outcome="warning" if bad else "note",
            verdict=f"{bad} of {len(rows)} could not be diagnosed" if bad else "",
        ),
        folder / "fleet.html",
    )


def _build_count_table(rows: Sequence[_Row]) -> Table:
    """Effects by the number of joints in which they were named."""
    joints: dict[str, list[str]] = {}
    for row in rows:
        for name in filter(None, str(row["named"]).split("+")):
            joints.setdefault(name, []).append(str(row["name"]))
    lines = [
        (name, str(len(where)), ", ".join(where[:8]) + (" …" if len(where) > 8 else ""))
        for name, where in sorted(joints.items(), key=lambda item: (-len(item[1]), item[0]))
    ]
    return Table(("effect", "joints", "which"), tuple(lines))


def _draw_shares(rows: Sequence[_Row]) -> Chart | None:
    effects = sorted({name for row in rows for name in str(row["named"]).split("+")})
    if not effects:
        return None
    shares = np.full((len(rows), len(effects)), np.nan)
    for index, row in enumerate(rows):
        for name, share in zip(str(row["named"]).split("+"), row["shares"], strict=True):
            shares[index, effects.index(name)] = share
    heat = HeatMap(
        np.arange(float(len(effects))),
        np.arange(float(len(rows))),
        shares,
        "share of the missing energy",
        x_names=tuple(effects),
        y_names=tuple(str(row["name"]) for row in rows),
        limits=(0.0, 1.0),
    )
    panel = Panel((heat,), "effect", "joint")
    return Chart("shares", "Share that each effect explains", (panel,), panel_height=180 + 22 * len(rows))
