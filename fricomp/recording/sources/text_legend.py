"""A legend above the rows, which says what columns called as channels hold: `Signal 1: axis 2 position (rad)`."""

import re
from collections.abc import Sequence

from fricomp.recording.quantity_word import count_known
from fricomp.recording.unit_word import find_unit_words

_ENTRY = re.compile(r"^[\s#%/*;\"']*(?P<name>[^:=\t;,\"']+?)[\"']?\s*[:=\t;,]\s*[\"']?(?P<said>.+?)[\"'\s;,]*$")
"""One channel a line: its name, a mark, and what it is."""


def name_by_legend(names: Sequence[str], above: Sequence[str]) -> tuple[str, ...]:
    """The names of columns, in place of those that say no quantity what a legend says of them.

    Args:
        names: As they stand in their line.
        above: The lines above the rows.
    """
    entries = [found for line in above if (found := _ENTRY.match(line))]
    legend = {_simplify(one["name"]): one["said"] for one in entries if _says_much(one["said"])}
    told = [legend.get(_simplify(name), "") if count_known([name]) == 0 else "" for name in names]
    return tuple(said or name for said, name in zip(told, names, strict=True)) if any(told) else tuple(names)


def _says_much(text: str) -> bool:
    return count_known([text]) > 0 or bool(find_unit_words(text, -1))


def _simplify(name: str) -> str:
    """A name without its case and the marks about it: `[CH 1]` is `ch 1`."""
    return " ".join(re.sub(r"[^\w]+", " ", name.lower()).split())
