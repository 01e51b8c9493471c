"""Columns of lists whose entries are named beside them, and columns that share a name."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.recording.sources.entry_names import NAMES_OF_ENTRIES
from fricomp.recording.validity import Samples

from .column import REPEATED, read_column_name

_NUMBERED = re.compile(r"(.+?)[:.\[]?(\d+)\]?")
"""What stands in a list, and where: `position:1`, `effort[0]`, `field.name0`."""
_LISTED_NAME = re.compile(r"[^\s,;'\"\[\]()]+")


def drop_numbered_twins(columns: dict[str, Samples]) -> dict[str, Samples]:
    """The columns without `position:2` where names that stand beside have told its entries apart: `elbow.position`,
    `position.elbow`."""
    numbered = Counter(base for base, _, number in (name.rpartition(":") for name in columns) if number.isdigit())

    def count_told(base: str) -> int:
        path, _, last = base.rpartition(".")
        below = sum(name.startswith(f"{base}.") for name in columns)
        own = [name for name in columns if not name.startswith(f"{base}.")]
        before = sum((name.endswith(f".{last}") and name.startswith(path)) or name.endswith(f".{base}") for name in own)
        return below or before

    twins = {base for base, count in numbered.items() if count_told(base) == count}
    return {name: values for name, values in columns.items() if name.rpartition(":")[0] not in twins}


def name_listed(columns: dict[str, Samples], words: Mapping[str, list[str]]) -> dict[str, Samples]:
    """The columns of lists by the names that stand beside them, in whatever order from row to row.

    The names are those of one cell, `['elbow', 'wrist']` beside `position:1`, or of as many cells as there are entries,
    `name[0]` beside `position[0]`.
    """
    listed = [cells for name, cells in words.items() if name.lower() in NAMES_OF_ENTRIES and cells[0][:1] in ("[", "(")]
    if listed:
        orders = {cell: tuple(_LISTED_NAME.findall(cell)) for cell in dict.fromkeys(listed[0])}
        return _name_entries(columns, [orders[cell] for cell in listed[0]])
    numbered = [(match, cells) for name, cells in words.items() if (match := _NUMBERED.fullmatch(name))]
    named = [(match, cells) for match, cells in numbered if match[1].rpartition(".")[2].lower() in NAMES_OF_ENTRIES]
    if not named:
        return columns
    return _name_entries(columns, list(zip(*(cells for _, cells in named), strict=True)), [one[2] for one, _ in named])


def _name_entries(
    columns: dict[str, Samples], rows: Sequence[tuple[str, ...]], numbers: Sequence[str] = ()
) -> dict[str, Samples]:
    """The columns with those of lists called by the names of their entries, where these are the same in all rows.

    Args:
        columns: By name; shape (n_rows,) each.
        rows: Names of the entries in each row.
        numbers: Of the entries, as the names of their columns state them; empty where they count from 1.
    """
    entries = rows[0]
    orders = set(rows)
    if any(sorted(order) != sorted(set(entries)) for order in orders):
        return columns
    numbers = numbers or [str(k) for k in range(1, len(entries) + 1)]
    matches = {name: match for name in columns if (match := _NUMBERED.fullmatch(name))}
    named = dict(columns)
    bases = {
        base: {match[2]: name for name, match in matches.items() if match[1] == base}
        for base in dict.fromkeys(match[1] for match in matches.values())
    }
    bases = {base: each for base, each in bases.items() if list(each) == list(numbers)}
    fields = Counter(base.rpartition(".")[2] for base in bases)
    for base, each in bases.items():
        path, _, field = base.rpartition(".")
        before = f"{path}." if fields[field] > 1 and path else ""  # `actual.positions` beside `desired.positions`
        table = np.stack([columns[name] for name in each.values()], axis=1)
        for entry in entries:
            places = {order: order.index(entry) for order in orders}
            chosen = table[np.arange(len(rows)), [places[order] for order in rows]]
            named[f"{before}{entry}.{field}"] = chosen
        for name in each.values():
            del named[name]
    return named


def number_repeated(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The names with a number behind those that several columns share which differ and are a quantity.

    Where all quantities come equally often they are those of as many joints: `position:2`. Else it is not known which
    is meant: `position#2`.
    """
    counts = Counter(name for name in names if read_column_name(name) is not None)
    repeated = {name for name, count in counts.items() if count > 1 and _differ(name, names, rows)}
    mark = ":" if repeated == set(counts) and len(set(counts.values())) == 1 else REPEATED
    seen: Counter[str] = Counter()
    numbered = []
    for name in names:
        seen[name] += 1
        numbered.append(f"{name}{mark}{seen[name]}" if name in repeated else name)
    return numbered


def fill_spans(names: Sequence[str]) -> list[str]:
    """The names with numbers where each quantity's stands above its own and as many nameless columns: `q,,,tau,,`."""
    starts = [k for k, name in enumerate(names) if read_column_name(name) is not None]
    if len(starts) < 2:
        return list(names)
    ends = [*starts[1:], len(names)]
    spans = {b - a for a, b in zip(starts, ends, strict=True)}
    if len(spans) != 1 or spans == {1} or any(names[k] for k in range(starts[0], len(names)) if k not in starts):
        return list(names)
    filled = list(names)
    for a, b in zip(starts, ends, strict=True):
        filled[a:b] = [f"{names[a]}:{k}" for k in range(1, b - a + 1)]
    return filled


def _differ(name: str, names: Sequence[str], rows: Sequence[Sequence[str]]) -> bool:
    """Whether the columns of this name hold different cells."""
    places = [k for k, one in enumerate(names) if one == name]
    return any(len({row[k] for k in places if k < len(row)}) > 1 for row in rows)
