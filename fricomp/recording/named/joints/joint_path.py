"""Joints of one name in several paths, such as those of two arms, and what a joint needs to be one."""

import re
from collections.abc import Mapping
from dataclasses import replace

from fricomp.recording.unit_word import read_bracket

from ..column import ColumnMeaning, read_column_name, simplify_joint

Candidates = dict[str, dict[str, list[tuple[str, ColumnMeaning]]]]
"""Columns and their meanings by what is left of their names for the joint, and by channel."""
_BRACKET = re.compile(r"[\[(]([^\])]*)[\])]")
"""What may be a unit with a mark of paths in it: `[rad/s]`."""


def is_complete(own: Mapping[str, object]) -> bool:
    """Whether the channels of a joint are those that a recording needs."""
    return "position" in own and ("torque" in own or "current" in own)


def separate_paths(joint: str, own: dict[str, list[tuple[str, ColumnMeaning]]]) -> Candidates:
    """Joints of one name that stand in different paths, such as those of two arms: each with a path before its name.

    Only where each of them has all that a joint needs: else they are of one joint, and one is chosen.
    """
    if not joint or max(map(len, own.values())) < 2:
        return {joint: own}
    apart: Candidates = {}
    for channel, found in own.items():
        for name, meaning in found:
            before = _find_path_before(name, joint)
            longer = f"{before}_{meaning.joint}" if before else meaning.joint
            each = apart.setdefault(simplify_joint(longer), {})
            each.setdefault(channel, []).append((name, replace(meaning, joint=longer)))
    return apart if len(apart) > 1 and all(map(is_complete, apart.values())) else {joint: own}


def _find_path_before(name: str, joint: str) -> str:
    """What stands in front of a joint in the path of a name: of `left_arm/elbow/position` and `left_arm/elbow_pos` the
    arm; without the words of a quantity, `pos_left_arm/elbow`.
    """
    path = re.split(r"[/.]", _BRACKET.sub(lambda found: "" if read_bracket(found.group(1)) else found.group(), name))
    at = len(path) - 2 if len(path) > 2 and simplify_joint(path[-2]) == joint else len(path) - 1
    if at < 1 or joint not in simplify_joint(path[at]):
        return ""
    meaning = read_column_name(path[at - 1])
    return path[at - 1] if meaning is None else meaning.joint
