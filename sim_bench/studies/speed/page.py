"""The page on speed, in Markdown, with its growth curves."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fricomp.report import Chart, Line, Panel, Points, draw_png

from ..kit.page import write_page as fill_page
from .measure import SpeedFigures
from .timing import Growth, Timing


def write_page(figures: SpeedFigures, page: Path, measured: str, command: str) -> None:
    """Write the Markdown page and, beside it in a folder of its name, the picture of the growth.

    Args:
        figures: What was measured.
        page: File.
        measured: When, and at which commit, in a sentence.
        command: That measures it again.
    """
    picture = page.with_suffix("") / "growth.png"
    picture.parent.mkdir(parents=True, exist_ok=True)
    draw_png(draw_growth(figures.growth), picture)
    fill_page(
        "speed/page.md",
        page,
        measured=measured,
        command=f"{command} --page docs/{page.name}",
        unit=f"{figures.unit:.3g}",
        picture=f"{page.stem}/{picture.name}",
        rows=list_rows(figures.timings),
        growth=[[one.group, f"{one.exponent:.2f}"] for one in figures.growth],
        peers=[[one.name, one.ours, f"{one.units:.3g}", f"{one.of_ours:.3g}"] for one in figures.peers],
        absent=", ".join(figures.absent),
        first=[[name, f"{units:.3g}", f"{wall:.2g}"] for name, units, wall in figures.first],
        slowest=figures.slowest,
        profile=[[name, f"{share:.0%}"] for name, share in figures.profile],
    )


def list_rows(timings: Sequence[Timing]) -> list[list[str]]:
    """A row for each timing: what, units, processor time, time that passed, joints simulated."""
    return [
        [one.name, f"{one.units:.3g}", f"{one.seconds:.3g}", f"{one.wall:.3g}", f"{one.joints}" if one.joints else "–"]
        for one in timings
    ]


def draw_growth(growth: Sequence[Growth]) -> Chart:
    """A panel for each group: units over size, beside a line of linear growth."""
    panels = []
    for one in growth:
        sizes = np.array([timing.size for timing in one.timings])
        units = np.array([timing.units for timing in one.timings])
        linear = Line(sizes, units[0] * sizes / sizes[0], "linear", color=7, stroke="dashed")
        marks = (Points(sizes, units, "measured", color=0, size=6.0), Line(sizes, units, "", color=0), linear)
        measure = one.group.partition(": ")[2]
        panels.append(Panel(marks, measure, "units", one.group, x_scale="log", y_scale="log"))
    return Chart("growth", "Processor time over size", tuple(panels), columns=3, panel_height=260)
