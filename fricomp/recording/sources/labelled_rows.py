"""Rows that label each number, as a microcontroller prints them: `t=0.001 q=0.12`, `ms:1,pos:0.12`, `{"t": 0.1, …}`."""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["tabulate_labelled"]

_LABELLED = re.compile(
    r"""["']?([A-Za-z_][\w./]*(?:\s?[\[(][^\])]*[\])])?)["']?\s*[:=]\s*"""
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan)(?![\w.:])",
    re.IGNORECASE,
)
_FEWEST = 2
"""Labelled numbers in a row: lines of a header have one each."""
_FIRST_LINES = 200


def tabulate_labelled(lines: Sequence[str], *, is_whole: bool = True) -> list[str] | None:
    """The lines of a table with the labels as its names; None where most lines have no labels.

    Lines without labels, such as those of a boot, are left out, and so is the last one where it was cut off.

    Args:
        lines: Of a text.
        is_whole: Whether the last one has ended.
    """
    labels = [len(_LABELLED.findall(line)) for line in lines[:_FIRST_LINES]]
    if sum(count >= _FEWEST for count in labels) < 0.5 * len(labels):
        return None
    rows = [dict(found) for line in (lines if is_whole else lines[:-1]) if len(found := _LABELLED.findall(line)) > 1]
    names = list(dict.fromkeys(name for row in rows for name in row))
    header = ",".join(f'"{name}"' if "," in name else name for name in names)
    return [header, *(",".join(row.get(name, "") for name in names) for row in rows)]
