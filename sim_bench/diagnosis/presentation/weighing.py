"""What was weighed: rival explanations, what this recording can tell apart, and orders over position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.report import Bars, Chart, HeatMap, Line, Panel, Rule, Table

from ..result import DiagnosisRecord, Distinguishability, Rival
from ..track import FloatArray
from .over_time import AFTER, BEFORE, NOISE
from .wording import Units

__all__ = ["distinguishability_chart", "order_chart", "rival_chart", "rival_table"]

_MOST = 14


def rival_chart(rivals: Sequence[Rival]) -> Chart | None:
    """Evidence for each explanation, best first."""
    shown = [rival for rival in rivals if rival.gain > 0.0][:_MOST]
    if not shown:
        return None
    names = tuple(" + ".join(rival.effects) for rival in shown)
    gains = np.array([rival.gain for rival in shown])
    accepted = np.array([not rival.refused for rival in shown])
    marks = (
        Bars(names, np.where(accepted, gains, np.nan), "passed every gate", color=AFTER),
        Bars(names, np.where(accepted, np.nan, gains), "refused", color=NOISE),
    )
    wide = gains.max() > 50.0 * gains.min()
    panel = Panel(marks, "", "evidence (BIC gain) [1]", y_scale="log" if wide else "linear")
    caption = (
        "How much better each explanation fits after everything was fitted again with it, less a penalty for its "
        "parameters. The bar must also pass the largest value that recordings with nothing missing reach."
    )
    return Chart("rivals", "Evidence after a joint refit", (panel,), caption=caption, panel_height=360)


def rival_table(rivals: Sequence[Rival]) -> Table | None:
    """Explanations with what spoke against them."""
    if not rivals:
        return None
    rows = tuple(
        (
            " + ".join(rival.effects),
            f"{rival.gain:,.0f}",
            "–" if rival.coverage is None else f"{rival.coverage:.1%}",
            rival.refused or "accepted",
        )
        for rival in rivals[:_MOST]
    )
    return Table(("explanation", "evidence", "coverage", "verdict"), rows)


def distinguishability_chart(found: Distinguishability | None) -> Chart | None:
    """Which effects this recording can tell apart."""
    if found is None or len(found.names) < 2:
        return None
    n = len(found.names)
    heat = HeatMap(
        np.arange(float(n)),
        np.arange(float(n)),
        np.array(found.matrix, dtype=np.float64),
        "1 − R²",
        x_names=found.names,
        y_names=found.names,
        limits=(0.0, 1.0),
    )
    panel = Panel((heat,), "by these", "how well this one is told apart")
    caption = (
        "0: the effect of the row looks like that of the column on this recording, once the base model is fitted "
        "again; 1: nothing of it can be explained by the other."
    )
    title, height = "Part of the row that the column cannot explain", 200 + 19 * n
    return Chart("distinguishability", title, (panel,), caption=caption, panel_height=height)


def order_chart(orders: Mapping[str, FloatArray], record: DiagnosisRecord, units: Units) -> Chart | None:
    """Energy that a ripple of each order over position explains."""
    before = orders.get("energy")
    if before is None:
        return None
    marks = [Line(orders["order"], before, "before", color=BEFORE, width=1.2)]
    if record.effects and "after" in orders:
        marks.append(Line(orders["order"], orders["after"], "with what was named", color=AFTER, width=1.2))
    named = [
        Rule(effect.parameters["order"].value, "x", f"{effect.name}: {effect.parameters['order'].value:.5g}", color=4)
        for effect in record.effects
        if "order" in effect.parameters
    ]
    rotary = units.position == "rad"
    label = "order: waves per turn [1]" if rotary else f"order [rad/{units.position}]"
    panel = Panel((*marks, *named), label, "energy explained [noise variances]")
    caption = f"A ripple of order n has the period 2π/n in {units.position}."
    return Chart("orders", "Energy that a ripple of each order explains", (panel,), caption=caption, panel_height=280)
