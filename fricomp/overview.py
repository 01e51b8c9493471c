"""What a result shows of itself: one line at a prompt, a text with tables, and the same as HTML in a notebook."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from math import floor, isfinite, log10

AT_BOUND = "at the bound"
"""Said of a number that stands where its domain or the search for it ends: the data ask for more than that."""


@dataclass(frozen=True)
class OverviewTable:
    """Rows of text below their heads.

    Attributes:
        heads: Names of the columns, with their units where a column has one unit.
        rows: Cells, as many a row as there are heads.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def as_text(self) -> str:
        """Columns side by side, the first to the left, numbers below each other."""
        lines = (self.heads, *self.rows)
        widths = [max(len(line[column]) for line in lines) for column in range(len(self.heads))]
        return "\n".join("  ".join(f"{c:<{w}}" for c, w in zip(line, widths, strict=True)).rstrip() for line in lines)

    def as_html(self) -> str:
        """The same as an HTML table."""
        return f"<table><thead>{_row(self.heads, 'th')}</thead><tbody>{''.join(map(_row, self.rows))}</tbody></table>"


@dataclass(frozen=True)
class Overview:
    """A result in short.

    Attributes:
        title: What it is, in one line.
        sentences: What to know about it, most important first.
        tables: Its numbers, with units.
    """

    title: str
    sentences: tuple[str, ...] = ()
    tables: tuple[OverviewTable, ...] = ()

    def as_text(self) -> str:
        """Title, tables and sentences, apart by empty lines."""
        tables = (table.as_text() for table in self.tables if table.rows)
        return "\n\n".join(part for part in (self.title, *tables, "\n".join(self.sentences)) if part)

    def as_html(self) -> str:
        """The same for a notebook."""
        tables = "".join(table.as_html() for table in self.tables if table.rows)
        return f"<div><p><b>{escape(self.title)}</b></p>{tables}{''.join(_paragraphs(self.sentences))}</div>"


class Shown(ABC):
    """A result that shows itself; it says what in `overview`."""

    @abstractmethod
    def overview(self) -> Overview:
        """Title, sentences and tables."""

    @abstractmethod
    def headline(self) -> str:
        """What it is, in a few words, quickly."""

    def summary(self) -> str:
        """A text with everything that is worth knowing, with units; to be printed."""
        return self.overview().as_text()

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__} {self.headline()}>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return self.overview().as_html()


def format_with_reach(value: float, reach: float, *, at_bound: bool = False) -> str:
    """A value and half of its interval, to the digits that the interval leaves; and that it is at its bound."""
    end = f", {AT_BOUND}" if at_bound else ""
    if not isfinite(reach):
        return f"cannot be determined{end}"
    decimals = max(0, min(9, 1 - floor(log10(reach)))) if reach > 0.0 else 6
    return f"{value:.{decimals}f} ± {reach:.{decimals}f}{end}"


def format_range(limits: tuple[float, float], unit: str) -> str:
    """Lowest and highest value with their unit."""
    return f"{limits[0]:.4g} to {limits[1]:.4g} {unit}".rstrip()


def _row(cells: Iterable[str], kind: str = "td") -> str:
    return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"


def _paragraphs(sentences: Iterable[str]) -> Iterable[str]:
    return (f"<p>{escape(sentence)}</p>" for sentence in sentences)
