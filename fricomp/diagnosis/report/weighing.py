"""What was weighed: rival explanations, what this recording can tell apart, and orders over position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.laws import FloatArray
from fricomp.report import Bars, Chart, HeatMap, Line, Panel, Rule, Table

from ..record.result import DiagnosisRecord, Distinguishability, NamedEffect, Rival
from .over_time import AFTER, BASE, BEFORE, NAMED, NOISE
from .settings import REPORT
from .wording import Units

_ACCEPTED, _ALIKE, _REFUSED = "named", "cannot be told from what was named", "refused"
_OUTCOME_COLORS = {_ACCEPTED: AFTER, _ALIKE: 5, _REFUSED: NOISE}


def draw_rival_chart(rivals: Sequence[Rival], effects: Sequence[NamedEffect] = ()) -> Chart | None:
    """Evidence for each explanation, best first.

    Args:
        rivals: What was weighed.
        effects: What was named.
    """
    shown = [rival for rival in rivals if rival.gain > REPORT.least_gain][: REPORT.rivals]
    if not shown:
        return None
    names = tuple(" + ".join(rival.effects) for rival in shown)
    gains = np.array([rival.gain for rival in shown])
    outcomes = [_judge_outcome(rival, effects) for rival in shown]
    marks = tuple(
        Bars(names, np.where([one == outcome for one in outcomes], gains, np.nan), outcome, color=color)
        for outcome, color in _OUTCOME_COLORS.items()
        if outcome in outcomes
    )
    wide = gains.max() > REPORT.wide * gains.min()
    panel = Panel(marks, "", "evidence (BIC gain) [1]", y_scale="log" if wide else "linear")
    caption = (
        "How much better each explanation fits after everything was fitted again with it: fall of the squared "
        "residual in noise variances, less a penalty for its parameters. It must pass what recordings with nothing "
        "missing reach."
    )
    return Chart("rivals", "Evidence for each explanation", (panel,), caption=caption, panel_height=360)


def _judge_outcome(rival: Rival, effects: Sequence[NamedEffect]) -> str:
    """Whether an explanation was named, cannot be told from what was named, or was refused."""
    if not rival.refused:
        return _ACCEPTED
    named, tried = {one.name: one for one in effects if one.share > 0.0}, set(rival.effects)
    left_out, instead = set(named) - tried, tried - set(named)
    alike = len(left_out) == len(instead) == 1 and instead <= set(named[min(left_out)].indistinguishable_from)
    return _ALIKE if alike else _REFUSED


def build_rival_table(rivals: Sequence[Rival], effects: Sequence[NamedEffect] = ()) -> Table | None:
    """Explanations with what spoke against them.

    Args:
        rivals: What was weighed.
        effects: What was named.
    """
    if not rivals:
        return None
    rows = tuple(
        (
            " + ".join(rival.effects),
            f"{rival.gain:,.0f}" if rival.gain else "–",
            "–" if rival.coverage is None else f"{rival.coverage:.1%}",
            rival.refused if (found := _judge_outcome(rival, effects)) == _REFUSED else found,
        )
        for rival in rivals[: REPORT.rivals]
    )
    caption = "Coverage is the part of what can be explained that each explanation takes."
    return Table(("explanation", "evidence", "coverage", "outcome"), rows, caption)


def draw_distinguishability(found: Distinguishability | None) -> Chart | None:
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
    panel = Panel((heat,), "imitated by this effect", "effect")
    caption = (
        "0 (dark): on this recording the effect of the row looks just like that of the column, once the base model is "
        "fitted again, so the two cannot be told apart. 1 (bright): they have nothing in common."
    )
    title, height = "Part of each effect that another one cannot imitate", 260 + 19 * n
    return Chart("distinguishability", title, (panel,), caption=caption, panel_height=height)


def draw_order_chart(orders: Mapping[str, FloatArray], record: DiagnosisRecord, units: Units) -> Chart | None:
    """Energy that a ripple of each order over position explains."""
    before = orders.get("energy")
    if before is None:
        return None
    marks = [Line(orders["order"], before, BASE, color=BEFORE, width=1.2)]
    if record.effects and "after" in orders:
        marks.append(Line(orders["order"], orders["after"], NAMED, color=AFTER, width=1.2))
    named = [
        Rule(effect.parameters["order"].value, "x", f"{effect.name}: {effect.parameters['order'].value:.5g}", color=4)
        for effect in record.effects
        if "order" in effect.parameters and effect.parameters["order"].unit != "1"  # that of a filter
    ]
    rotary = units.position == "rad"
    label = "order: waves in a turn [1]" if rotary else f"order [rad/{units.position}]"
    panel = Panel((*marks, *named), label, "energy explained [noise variances]")
    caption = f"A ripple of order n repeats every 2π/n {units.position}. Noise alone gives about 2 at every order."
    return Chart("orders", "Energy that a ripple of each order explains", (panel,), caption=caption, panel_height=280)
