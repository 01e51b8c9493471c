"""What a controller asks for, called as what was measured: `servo_control.position` beside `servo_stats.position`."""

from dataclasses import replace

from ..column import REFERENCES, ColumnMeaning
from .joint_path import Candidates

_CONTROL = "control"
_STATS = ("", "stats", "status", "telemetry", "query")
"""Last words of a path that holds what was measured, which tell no joint from another."""


def take_controls(candidates: Candidates) -> Candidates:
    """The columns of each joint, where those of its control are what it was asked for, and none of another joint.

    What they do not say of their unit is that of the measured column.

    Args:
        candidates: Columns and their meanings by joint and channel.
    """
    taken = dict(candidates)
    for joint in candidates:
        before, _, last = joint.rpartition("_")
        paths = ["_".join(filter(None, (before, word))) for word in _STATS]
        measured = next((one for one in paths if "position" in taken.get(one, {})), None)
        if last == _CONTROL and measured is not None:
            taken[measured] = _with_references(taken[measured], taken.pop(joint), measured)
    return taken


def _with_references(
    own: dict[str, list[tuple[str, ColumnMeaning]]], control: dict[str, list[tuple[str, ColumnMeaning]]], joint: str
) -> dict[str, list[tuple[str, ColumnMeaning]]]:
    """The columns of a joint with those of its control as its references."""
    both = {channel: list(found) for channel, found in own.items()}
    for channel, found in control.items():
        if channel not in REFERENCES:
            continue
        unit = own[channel][0][1].unit if channel in own else ""
        asked = [
            (name, replace(one, channel=REFERENCES[channel], joint=joint, unit=one.unit or unit)) for name, one in found
        ]
        both.setdefault(REFERENCES[channel], []).extend(asked)
    return both
