"""Charts of the page of a proof."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.report import Chart, HeatMap, Line, Panel, Points

from .power import PowerPoint


def draw_power(points: Sequence[PowerPoint]) -> Chart:
    """Shares against strength, beside the oracle's."""
    enr = np.array([point.enr for point in points])
    order = np.argsort(enr)
    oracle = np.array([p.oracle for p in points])[order]
    marks = [Line(enr[order], oracle, "likelihood-ratio oracle", color=0, stroke="dashed")]
    rows = (("called missing", [p.detected for p in points]), ("right name first", [p.named for p in points]))
    for color, (name, shares) in enumerate(rows, 1):
        half = np.array([0.5 * (s.high - s.low) for s in shares])
        middle = np.array([0.5 * (s.high + s.low) for s in shares])
        beside = enr * (0.985 if color == 1 else 1.015)  # bars of one place would hide each other
        marks.append(Line(enr[order], np.array([s.share for s in shares])[order], name, color=color))
        marks.append(Points(beside, middle, error=half, size=0.1, color=color))  # type: ignore[arg-type]
    panel = Panel(
        tuple(marks), "effect-to-noise ratio after the base refit", "share of cases", x_scale="log", y_range=(0.0, 1.05)
    )
    return Chart("power", "Power against strength", (panel,), caption="Bars are exact 95 % intervals.")


def draw_confusion(table: Mapping[str, Counter[str]]) -> Chart:
    """For each effect, how often each answer came first; answers that name what was concealed lie on a diagonal."""
    given = {answer for row in table.values() for answer in row}
    answers = [name for name in table if name in given]
    answers += sorted(given.difference(answers), key=lambda name: (name.startswith("("), name))
    counts = np.array([[row[answer] for answer in answers] for row in table.values()])
    shares = counts / counts.sum(axis=1, keepdims=True)
    shares[counts == 0] = np.nan
    texts = tuple(tuple(str(count or "") for count in row) for row in counts[::-1])
    names = tuple(f"{name} ({sum(row.values())})" for name, row in table.items())[::-1]
    x, y = (np.arange(n, dtype=np.float64) for n in shares.shape[::-1])
    heat = HeatMap(
        x, y, shares[::-1], "share of cases",
        x_names=tuple(answers), y_names=names, limits=(0.0, 1.0), texts=texts,
    )  # fmt: skip
    panel = Panel((heat,), "answer", "concealed (cases)")
    return Chart("confusion", "Which answer came first", (panel,), panel_height=200 + 18 * len(names))
