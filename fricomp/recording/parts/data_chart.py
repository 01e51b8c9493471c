"""The picture of what was used of a recording and what was not, and what its channels can show at all."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum, read_at_rest
from fricomp.recording.metadata import channel_units
from fricomp.recording.parts.parts import UsableParts
from fricomp.recording.recording import Recording
from fricomp.report import Chart, Line, Panel, Points, Table

_MOST_SHOWN = 6000
"""Rows of a chart; more lie on each other."""
_ROOM = 0.15
"""Part of the range of what was used within which what was left out is drawn."""
_USED, _LEFT_OUT = 0, 1
"""Colours."""
_SHOWN = ("position", "torque", "velocity", "load_torque", "motor_position")
"""Channels whose steps are told."""


def draw_data_chart(usable: UsableParts, name: str, title: str) -> Chart:
    """Position and torque over time: what was used, and what was left out.

    Args:
        usable: The recording and its parts.
        name: Of the chart.
        title: Above it.
    """
    source, used = usable.source, find_used_rows(usable)
    units = channel_units(source.metadata)
    shown = np.arange(0, len(source), max(1, len(source) // _MOST_SHOWN))
    panels = tuple(
        Panel(_marks(np.asarray(source.channels[one]), source, used, shown), "time [s]", f"{one} [{units[one]}]")
        for one in ("position", "torque")
    )
    return Chart(name, title, panels, panel_height=170, share_x=True, caption=" ".join(usable.sentences))


def _marks(
    values: NDArray[np.float64], source: Recording, used: NDArray[np.bool_], shown: NDArray[np.intp]
) -> tuple[Line | Points, ...]:
    time = np.asarray(source.time) - source.time[0]
    line = Line(time[shown], np.where(used, values, np.nan)[shown], "used", color=_USED, width=1.0)
    others = np.flatnonzero(~used)
    others = others[:: max(1, others.size // _MOST_SHOWN)]
    if not others.size or not used.any():
        return (line,)
    low, high = float(values[used].min()), float(values[used].max())
    room = _ROOM * (high - low)
    at = np.clip(values[others], low - room, high + room)  # an outlier stands at the edge, or nothing else would show
    return (line, Points(time[others], at, "left out", color=_LEFT_OUT, size=2.0))


def find_used_rows(usable: UsableParts) -> NDArray[np.bool_]:
    """Which rows of the source are in its parts. Shape (n_samples,).

    Where stamps were made even or rows brought to another rate, a row is used where it lies within a part.
    """
    time = np.asarray(usable.source.time)
    kept = np.concatenate([np.asarray(part.time) for part in usable.parts])
    same = np.isin(time, kept)
    if np.count_nonzero(same) == kept.size:
        return same
    inside = np.zeros(time.size, dtype=bool)
    for part in usable.parts:
        half = part.sample_period
        inside |= (time >= part.time[0] - half) & (time <= part.time[-1] + half)
    return inside


def build_data_table(usable: UsableParts) -> Table:
    """Rate and clock of a recording, and of each channel its step and what it reads at rest."""
    kept, clock = usable.kept, usable.clock
    units = channel_units(kept.metadata)
    rows = [("time", "s", f"{kept.sample_period:.4g}", f"stamps are off by {clock.error:.2g} s" if clock.error else "")]
    for name in _SHOWN:
        values = kept.channels.get(name)
        if values is None:
            continue
        quantum = measure_quantum(np.asarray(values))
        rest = read_at_rest(kept) if name == "velocity" else None
        said = f"{rest.bias:.3g} ± {rest.width:.2g} at rest" if rest is not None and rest.width > 0.0 else ""
        rows.append((name, units[name], f"{quantum:.4g}" if quantum > 0.0 else "none seen", said))
    return Table(("channel", "unit", "step", "what else"), tuple(rows))
