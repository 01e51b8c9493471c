"""Columns of a joint whose own name says something else: `q_theta1`, `tau_theta1`; `q_A`, `force_A`; `i_elbow`."""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from fricomp.recording.quantity_word import WORDS, split_words
from fricomp.recording.unit_word import kind_of_unit, read_unit

from ..column import ColumnMeaning, read_column_name, simplify_joint

_CURRENT = "i"
"""The letter of a current, which alone may be anything."""


def read_shared_rests(names: Iterable[str]) -> dict[str, ColumnMeaning]:
    """Meanings of the columns that begin with the words of different quantities, and end alike, in such a word too or
    in the letter of a unit that no position has.

    Where a position and a torque or a current end so, what they end in is the name of a joint.

    Args:
        names: Of all columns.
    """
    groups: dict[str, dict[str, ColumnMeaning]] = {}
    for name in names:
        words = split_words(name)
        first = next((k for k, (word, _) in enumerate(words) if word in WORDS), len(words))
        if first or len(words) < 2:
            continue
        cut = words[1][1][0]
        if not any(word in WORDS for word, _ in words[1:]) and not _is_letter_of_unit(name[cut:]):
            continue
        meaning = read_column_name(name[:cut].rstrip("_.:/ "))
        if meaning is not None:
            groups.setdefault(name[cut:], {})[name] = replace(meaning, joint=name[cut:])
    found: dict[str, ColumnMeaning] = {}
    for own in groups.values():
        channels = {meaning.channel for meaning in own.values()}
        if "position" in channels and channels & {"torque", "current"}:
            found |= own
    return found


def _is_letter_of_unit(text: str) -> bool:
    """Whether a text is a capital that is a unit, and none of a position."""
    return len(text) == 1 and text.isupper() and kind_of_unit(read_unit(text)) not in ("", "position")


def read_currents(names: Iterable[str], known: Mapping[str, ColumnMeaning]) -> dict[str, ColumnMeaning]:
    """Meanings of columns such as `i_elbow`, where another one is the position of `elbow`.

    Args:
        names: Of all columns.
        known: Meanings of those that are told by their words.
    """
    moved = {simplify_joint(one.joint) for one in known.values() if one.channel == "position" and one.joint}
    found = {}
    for name in names:
        words = split_words(name)
        if name in known or len(words) < 2 or words[0][0] != _CURRENT:
            continue
        joint = name[words[1][1][0] :]
        if simplify_joint(joint) in moved:
            found[name] = ColumnMeaning("current", joint, 0, "")
    return found
