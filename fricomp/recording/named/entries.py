"""Columns of lists whose entries are named beside them, and columns that share a name."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from fricomp.recording.sources.entry_names import NAMES_OF_ENTRIES
from fricomp.recording.validity import Samples

from .column import REPEATED, read_column_name

_LISTED_NAME = re.compile(r"[^\s,;'\"\[\]()]+")


def drop_numbered_twins(columns: dict[str, Samples]) -> dict[str, Samples]:
    """The columns without `position:2` where names that stand beside have told its entries apart: `elbow.position`."""
    numbered = Counter(base for base, _, number in (name.rpartition(":") for name in columns) if number.isdigit())

    def count_told(base: str) -> int:
        path, _, last = base.rpartition(".")
        return sum(
            name.endswith(f".{last}") and name.startswith(path) and not name.startswith(f"{base}.") for name in columns
        )

    twins = {base for base, count in numbered.items() if count_told(base) == count}
    return {name: values for name, values in columns.items() if name.rpartition(":")[0] not in twins}


def name_listed(columns: dict[str, Samples], words: Mapping[str, list[str]]) -> dict[str, Samples]:
    """The columns of lists by the names that a cell beside them lists, in whatever order: `['elbow', 'wrist']`."""
    listed = [cells for name, cells in words.items() if name.lower() in NAMES_OF_ENTRIES and cells[0][:1] in ("[", "(")]
    if not listed:
        return columns
    cells, named = listed[0], dict(columns)
    orders = {cell: _LISTED_NAME.findall(cell) for cell in dict.fromkeys(cells)}
    entries = list(dict.fromkeys(entry for order in orders.values() for entry in order))
    if any(sorted(order) != sorted(entries) for order in orders.values()):
        return columns
    for base in dict.fromkeys(name.rpartition(":")[0] for name in columns):
        each = [one for one in columns if re.fullmatch(rf"{re.escape(base)}:\d+", one)]
        if base and base not in words and len(each) == len(entries):
            table = np.stack([columns[one] for one in each], axis=1)
            for entry in entries:
                places = [orders[cell].index(entry) for cell in cells]
                named[f"{entry}.{base}"] = table[np.arange(len(cells)), places]
    return drop_numbered_twins(named)


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
