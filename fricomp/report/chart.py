"""A chart as plain data: panels with axes, and marks in them. Nothing here draws."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricomp.errors import ParameterError

__all__ = ["CROWDED", "PALETTE", "Band", "Bars", "Chart", "HeatMap", "Line", "Mark", "Panel", "Points", "Rule"]

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#4D4D4D", "#8C6D1F")
"""Colours that remain apart for colour-blind readers [okabe2008]; a mark's `color` counts from 0."""

CROWDED = 12
"""Names along x from which they stand upright in a heat map."""

Values = NDArray[np.float64]
Scale = Literal["linear", "log"]
Stroke = Literal["solid", "dashed", "dotted"]


@dataclass(frozen=True, eq=False)
class Line:
    """A curve through points. NaN breaks it.

    Attributes:
        x: Shape (n,).
        y: Shape (n,).
        label: Name in the legend; empty for none.
        color: Index into `PALETTE`; None takes the next one of the panel.
        stroke: How it is drawn.
        width: Line width [pt].
    """

    x: Values
    y: Values
    label: str = ""
    color: int | None = None
    stroke: Stroke = "solid"
    width: float = 1.6

    def __post_init__(self) -> None:
        _freeze_columns(self, "x", "y")


@dataclass(frozen=True, eq=False)
class Points:
    """Markers, with error bars where there are errors.

    Attributes:
        x: Shape (n,).
        y: Shape (n,).
        label: Name in the legend; empty for none.
        error: Half length of the error bars, shape (n,), in the unit of y; None for none.
        color: Index into `PALETTE`; None takes the next one of the panel.
        hollow: Outline only, such as for what was rejected.
        size: Diameter [pt].
    """

    x: Values
    y: Values
    label: str = ""
    error: Values | None = None
    color: int | None = None
    hollow: bool = False
    size: float = 5.0

    def __post_init__(self) -> None:
        _freeze_columns(self, "x", "y", *(["error"] if self.error is not None else []))


@dataclass(frozen=True, eq=False)
class Band:
    """The area between two curves, such as a 95 % interval.

    Attributes:
        x: Shape (n,).
        low: Shape (n,).
        high: Shape (n,).
        label: Name in the legend; empty for none.
        color: Index into `PALETTE`; None takes the next one of the panel.
    """

    x: Values
    low: Values
    high: Values
    label: str = ""
    color: int | None = None

    def __post_init__(self) -> None:
        _freeze_columns(self, "x", "low", "high")


@dataclass(frozen=True, eq=False)
class Bars:
    """One bar a category; the marks of a panel share its places, the first category at the left.

    Attributes:
        categories: Names along x.
        values: Shape (n,).
        label: Name in the legend; empty for none.
        error: Half length of the error bars, shape (n,); None for none.
        color: Index into `PALETTE`; None takes the next one of the panel.
    """

    categories: tuple[str, ...]
    values: Values
    label: str = ""
    error: Values | None = None
    color: int | None = None

    def __post_init__(self) -> None:
        _freeze_columns(self, "values", *(["error"] if self.error is not None else []))
        if len(self.categories) != self.values.size:
            raise ParameterError(f"{self.values.size} bars have {len(self.categories)} categories: give one for each")


@dataclass(frozen=True, eq=False)
class HeatMap:
    """Colour over a grid.

    Attributes:
        x: Shape (n_columns,).
        y: Shape (n_rows,).
        values: Shape (n_rows, n_columns); NaN stays empty.
        color_label: What the colour means, with its unit; empty for no scale beside the map.
        diverging: Whether zero is the middle, such as for correlations.
        x_names: Names in place of x, such as of parameters.
        y_names: Names in place of y.
        limits: Values at the ends of the colour scale, so that several maps share one; None to fit.
        texts: What stands in the cells, such as counts, row by row; empty for nothing.
    """

    x: Values
    y: Values
    values: Values
    color_label: str = ""
    diverging: bool = False
    x_names: tuple[str, ...] = ()
    y_names: tuple[str, ...] = ()
    limits: tuple[float, float] | None = None
    texts: tuple[tuple[str, ...], ...] = ()

    def __post_init__(self) -> None:
        for name in ("x", "y", "values"):
            object.__setattr__(self, name, _read_only(getattr(self, name)))
        if self.values.shape != (self.y.size, self.x.size):
            raise ParameterError(f"a heat map over {self.y.size} x {self.x.size} has values {self.values.shape}")
        if self.texts and (len(self.texts), *set(map(len, self.texts))) != self.values.shape:
            raise ParameterError("a heat map has one text a cell, row by row, or none")


@dataclass(frozen=True)
class Rule:
    """A straight line across the panel at one value.

    Attributes:
        at: Where it stands, in the unit of the axis.
        axis: `x` for an upright line, `y` for a level one.
        label: Name in the legend; empty for none.
        color: Index into `PALETTE`.
    """

    at: float
    axis: Literal["x", "y"] = "y"
    label: str = ""
    color: int = 6


Mark = Line | Points | Band | Bars | HeatMap | Rule


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Attributes:
        marks: What is drawn, the last on top.
        x_label: With its unit, such as `velocity [rad/s]`.
        y_label: With its unit.
        title: Short; empty for none.
        x_scale: `linear` or `log`.
        y_scale: `linear` or `log`.
        y_range: Lowest and highest value shown; None to fit.
    """

    marks: tuple[Mark, ...]
    x_label: str
    y_label: str
    title: str = ""
    x_scale: Scale = "linear"
    y_scale: Scale = "linear"
    y_range: tuple[float, float] | None = None

    def colors(self) -> tuple[str, ...]:
        """The colour of each mark."""
        taken, found = 0, []
        for mark in self.marks:
            index = getattr(mark, "color", 0)
            if index is None:
                index, taken = taken, taken + 1
            found.append(PALETTE[index % len(PALETTE)])
        return tuple(found)

    def has_lone_bars(self) -> bool:
        """Whether no place has bars of two marks, so that each bar can stand in the middle of its category.

        Two categories of one name are two places.
        """
        taken: set[int] = set()
        for mark in self.marks:
            if isinstance(mark, Bars):
                here = set(np.flatnonzero(np.isfinite(mark.values)).tolist())
                if taken & here:
                    return False
                taken |= here
        return True


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels that belong together.

    Attributes:
        name: File stem and anchor, such as `friction-curve`.
        title: What it shows.
        panels: In reading order.
        columns: Panels side by side.
        caption: One or two sentences: what to see in it.
        panel_height: Height of each panel [px]; a PNG has the same proportions.
        share_x: Whether all panels show the same x, such as time.
    """

    name: str
    title: str
    panels: tuple[Panel, ...]
    columns: int = 1
    caption: str = ""
    panel_height: int = 320
    share_x: bool = False

    def __post_init__(self) -> None:
        if not self.panels or self.columns < 1:
            raise ParameterError(f"chart {self.name!r} needs at least one panel and one column")

    @property
    def rows(self) -> int:
        """Panels one above the other."""
        return -(-len(self.panels) // self.columns)

    def legends(self) -> tuple[tuple[str, ...], ...]:
        """Labels that each panel's legend has; what an earlier panel has named is not named again."""
        shown: set[tuple[str, str]] = set()
        found = []
        for panel in self.panels:
            new = []
            for mark, color in zip(panel.marks, panel.colors(), strict=True):
                label = getattr(mark, "label", "")
                if label and (label, color) not in shown:
                    shown.add((label, color))
                    new.append(label)
            found.append(tuple(new))
        return tuple(found)

    def legend_lines(self, letter: float, symbol: float, width: float) -> tuple[int, ...]:
        """Lines that each panel's legend takes above it; it may use the room of its neighbours where they have none.

        Args:
            letter: Width of a letter.
            symbol: Width of the symbol of an entry, and of the gaps around it.
            width: Of the whole chart.
        """
        legends, lines = self.legends(), []
        for number, labels in enumerate(legends):
            row = number - number % self.columns
            alone = sum(map(bool, legends[row : row + self.columns])) <= 1 and number == row
            room = width / (1 if alone else self.columns)
            lines.append(int(-(-sum(len(label) * letter + symbol for label in labels) // room)))
        return tuple(lines)


def _read_only(values: ArrayLike) -> Values:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


def _freeze_columns(mark: object, *names: str) -> None:
    arrays = {name: np.atleast_1d(_read_only(getattr(mark, name))) for name in names}
    sizes = {array.shape for array in arrays.values()}
    if len(sizes) != 1 or len(next(iter(sizes))) != 1:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise ParameterError(f"the columns of a {type(mark).__name__} must be of one length, got {shapes}")
    for name, array in arrays.items():
        object.__setattr__(mark, name, array)
