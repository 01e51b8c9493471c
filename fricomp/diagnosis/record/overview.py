"""What a diagnosis shows of itself at a prompt and in a notebook, read from its record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.overview import Overview, OverviewTable, Shown

from ..inputs.track import FloatArray
from .joint_name import call_joint

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fricomp.report import Chart

_REACH = 1.96
"""Half width of a 95 % interval in standard deviations [1]."""


class _Quantity(Protocol):
    @property
    def value(self) -> float: ...
    @property
    def unit(self) -> str: ...
    @property
    def ci95(self) -> tuple[float, float]: ...


class _Effect(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def parameters(self) -> Mapping[str, _Quantity]: ...


class _Change(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def given(self) -> float: ...
    @property
    def refitted(self) -> _Quantity: ...


class _HeldOut(Protocol):
    @property
    def unit(self) -> str: ...


class _Record(Protocol):
    """What is read of `DiagnosisRecord`."""

    @property
    def joint(self) -> str: ...
    @property
    def verdict(self) -> str: ...
    @property
    def sentences(self) -> tuple[str, ...]: ...
    @property
    def effects(self) -> Sequence[_Effect]: ...
    @property
    def changes(self) -> Sequence[_Change]: ...
    @property
    def heldout(self) -> _HeldOut | None: ...


class _Series(Protocol):
    """What is read of `RowSeries`."""

    @property
    def name(self) -> str: ...
    @property
    def time(self) -> FloatArray: ...
    @property
    def before(self) -> FloatArray: ...
    @property
    def after(self) -> FloatArray: ...
    @property
    def spread(self) -> FloatArray: ...


class _Evidence(Protocol):
    @property
    def series(self) -> Sequence[_Series]: ...


class DiagnosisOverview(Shown):
    """A diagnosis in one line, as a text, as HTML and as a picture."""

    record: _Record
    evidence: _Evidence

    def headline(self) -> str:
        """Joint, verdict and what was named."""
        names = ", ".join(effect.name for effect in self.record.effects)
        return f"of {call_joint(self.record.joint or '?')}: {self.record.verdict}{f' ({names})' if names else ''}"

    def overview(self) -> Overview:
        """The sentences of the answer, and the numbers of what was named and of what has moved."""
        record = self.record
        named = [
            (effect.name, name, f"{found.value:.4g}", f"{found.ci95[0]:.4g} to {found.ci95[1]:.4g}", found.unit)
            for effect in record.effects
            for name, found in effect.parameters.items()
        ]
        moved = [
            (change.name, f"{change.given:.4g}", f"{change.refitted.value:.4g}", change.refitted.unit)
            for change in record.changes
        ]
        return Overview(
            f"Diagnosis of {call_joint(record.joint or '?')}: {record.verdict}",
            record.sentences,
            (
                OverviewTable(("effect", "parameter", "value", "95 % interval", "unit"), tuple(named)),
                OverviewTable(("parameter of the simulation", "given", "refitted", "unit"), tuple(moved)),
            ),
        )

    def plot(self, recording: int = 0) -> Figure:
        """Draw what the simulation misses over time, before and after the named effects, with matplotlib.

        Args:
            recording: Number of the recording, counted from 0.

        Raises:
            DiagnosisError: The diagnosis has no curves of it: it was read from a file, or the data were bad.
            MissingExtraError: matplotlib is not installed.
        """
        from fricomp.report import draw_figure

        series = self.evidence.series
        if not 0 <= recording < len(series):
            raise DiagnosisError(
                f"there are curves of {len(series)} recordings, and number {recording} was asked for; a diagnosis that "
                "was read from a file, or that found the data bad, has none"
            )
        unit = "" if self.record.heldout is None else f" [{self.record.heldout.unit}]"
        return draw_figure(_missing_torque(series[recording], unit))


def _missing_torque(series: _Series, unit: str) -> Chart:
    from fricomp.report import Band, Chart, Line, Panel

    reach = _REACH * series.spread
    marks = (
        Band(series.time, -reach, reach, "noise (95 %)", color=6),  # the palette's grey
        Line(series.time, series.before, "before", color=1, width=1.0),
        Line(series.time, series.after, "with what was named", color=0, width=1.0),
    )
    largest = max(float(np.nanmax(np.abs(rows), initial=0.0)) for rows in (series.before, series.after))
    limits = (-1.1 * largest, 1.1 * largest) if largest > 0.0 else None  # a tenth of air above and below
    panel = Panel(marks, "time [s]", f"missing torque{unit}", y_range=limits)
    return Chart("missing-torque", f"Measured less simulated torque: {series.name}", (panel,))
