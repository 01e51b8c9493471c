"""The report of a diagnosis: the answer in sentences first, then what it rests on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from fricomp.recording.parts.data_chart import build_data_table, draw_data_chart
from fricomp.report import Chart, Outcome, ReportPage, Section, Table
from fricomp.root_mean_square import compute_rms

from ..record.joint_name import call_joint
from ..record.result import Diagnosis, Evidence, NamedEffect
from .maps import draw_map_chart, draw_plane_chart
from .over_time import draw_error_chart, draw_motion_chart, draw_time_chart, name_models
from .settings import REPORT
from .tables import (
    build_base_table,
    build_change_table,
    build_effect_table,
    build_error_table,
    build_forward_table,
    build_location_table,
    build_residual_table,
)
from .weighing import build_rival_table, draw_distinguishability, draw_order_chart, draw_rival_chart
from .wording import VERDICT_TITLES, Units, describe_next_step


def draw_diagnosis_charts(diagnosis: Diagnosis) -> dict[str, Chart]:
    """Every chart that the evidence allows, by name."""
    record, units = diagnosis.record, Units.read(diagnosis)
    evidence = _lower_floor(diagnosis.evidence) if record.effects else diagnosis.evidence
    models = name_models(record)
    changes = evidence.change_points or ((),) * len(evidence.series)
    found: list[Chart | None] = [draw_error_chart(evidence.files, units, models)]
    found += [
        draw_time_chart(series, units, i + 1, models, times)
        for i, (series, times) in enumerate(zip(evidence.series[: REPORT.recordings], changes, strict=False))
    ]
    found += [
        draw_map_chart(evidence, record.location, units, models),
        draw_plane_chart(evidence.series, units, models),
        draw_order_chart(evidence.orders, record, units),
        draw_rival_chart(record.rivals, record.effects),
        draw_distinguishability(record.distinguishability),
        draw_motion_chart(diagnosis.motion, units) if diagnosis.motion else None,
    ]
    found += [
        draw_data_chart(one, f"data-{number}" if len(diagnosis.data) > 1 else "data", "What was used of the recording")
        for number, one in enumerate(diagnosis.data[: REPORT.recordings], 1)
    ]
    return {chart.name: chart for chart in found if chart is not None}


def _lower_floor(evidence: Evidence) -> Evidence:
    """The evidence with the noise lowered to what the named model leaves, where that is less.

    A ripple too fine for the nulls is taken for noise by them; once it is named, the figures of the diagnosis stand
    beside a noise floor without it, and so must the charts.
    """
    left = [one.after / one.spread for one in evidence.series]
    scale = min(1.0, compute_rms(np.concatenate(left))) if left else 1.0
    if not 0.0 < scale < 1.0:
        return evidence
    series = tuple(replace(one, spread=scale * one.spread) for one in evidence.series)
    maps = {
        name: {what: values if what == "edges" else (1.0 + values) / scale**2 - 1.0 for what, values in found.items()}
        for name, found in evidence.maps.items()
    }
    return replace(evidence, series=series, maps=maps)


def build_diagnosis_page(
    diagnosis: Diagnosis,
    charts: Mapping[str, Chart],
    notes: tuple[str, ...],
    facts: Mapping[str, str],
    folder: Path | None = None,
) -> ReportPage:
    """The page.

    Args:
        diagnosis: What was found.
        charts: From `draw_diagnosis_charts`.
        notes: One sentence for each file that was written or could not be.
        facts: Further lines on how the diagnosis was made.
        folder: Where the proposed motion is written.
    """
    step = describe_next_step(diagnosis.record, folder)
    record, units = diagnosis.record, Units.read(diagnosis)
    over_time = [chart for name, chart in charts.items() if name.startswith("over-time")]
    made = Table(("what", "value"), tuple(facts.items())) if facts else None
    sections = [
        _build_section(
            "What was found",
            build_effect_table(record),
            *_explain_effects(record.effects),
            build_error_table(record),
            build_residual_table(record),
            build_forward_table(record),
        ),
        _build_section("What changed in the simulation", build_change_table(record)),
        _build_section("Before and after" if record.effects else "Over time", charts.get("torque-error"), *over_time),
        _build_section("Where it sits", build_location_table(record, units), charts.get("where"), charts.get("planes")),
        _build_section("Ripple over position", charts.get("orders")),
        _build_section("What was weighed", charts.get("rivals"), build_rival_table(record.rivals, record.effects)),
        _build_section("What this recording can tell apart", charts.get("distinguishability")),
        _build_section("What to record next", step, charts.get("motion")),
        _build_section(
            "The data",
            *map(build_data_table, diagnosis.data[: REPORT.recordings]),
            *(chart for name, chart in charts.items() if name.startswith("data")),
        ),
        _build_section("The base model", build_base_table(record), folded=True),
        _build_section("Files", *notes),
        _build_section("How it was made", made, folded=True),
    ]
    return ReportPage(
        title=f"{_name_joint(record.joint)}: {VERDICT_TITLES[record.verdict]}",
        subtitle=f"Diagnosis of {', '.join(record.recordings) or 'a recording'}",
        summary=record.sentences if step is None else (*record.sentences, step),
        sections=tuple(section for section in sections if section is not None),
        facts=_list_key_figures(diagnosis, units),
        outcome=_OUTCOMES[record.verdict],
        verdict="Not usable: the data cannot be diagnosed" if record.verdict == "bad_data" else "",
    )


_OUTCOMES: Final[dict[str, Outcome]] = {
    "bad_data": "failed",
    "consistent": "passed",
    "parameters": "warning",
    "measurement": "warning",
    "missing_physics": "note",
    "unknown_physics": "warning",
}
"""What the first card looks like."""


def _name_joint(name: str) -> str:
    """The joint's name, unless it has none but the default."""
    return "Diagnosis" if name in ("", "joint") else call_joint(name, "Joint")


def _build_section(title: str, *blocks: str | Chart | Table | None, folded: bool = False) -> Section | None:
    """A section of the blocks there are; None where there are none."""
    present = tuple(block for block in blocks if block is not None)
    return Section(title, present, folded=folded) if present else None


def _explain_effects(effects: tuple[NamedEffect, ...]) -> list[str]:
    """Kind, meaning, equation and source of each effect in one paragraph."""
    texts = []
    for effect in effects:
        equation = f" It is modelled as {effect.equation}." if effect.equation else ""
        source = f" Source: {effect.citation}, in docs/references.md." if effect.citation else ""
        texts.append(f"{effect.name} ({effect.kind}): {effect.sentence.rstrip('.')}.{equation}{source}")
    return texts


def _list_key_figures(diagnosis: Diagnosis, units: Units) -> dict[str, str]:
    record, facts = diagnosis.record, {"verdict": diagnosis.verdict.replace("_", " ")}
    if record.noise_ratio is not None:
        facts["residual over its noise"] = f"{record.noise_ratio:.2f}"  # as in the sentences
    if record.errors is not None:
        before, after = record.errors.before, record.errors.after
        torque, moved = f"{before.torque.rms:.3g}", f"{before.position[0].median:.3g}" if before.position else ""
        if after is not None:
            torque += f" → {after.torque.rms:.3g}"
            moved += f" → {after.position[0].median:.3g}" if moved and after.position else ""
        facts["held-out torque error"] = f"{torque} {units.torque}"
        if moved:
            facts[f"position error after {before.position[0].after:g} s"] = f"{moved} {units.position}"
    if record.heldout is not None and record.effects:
        facts["explained, of what can be"] = f"{record.heldout.explained:.0%}"
    return facts
